//! Files under way: `.partial-*` until they are whole, and gone when they never will be.
//!
//! One is removed when it is dropped, when its process is interrupted ([`abandon`]), and where that was killed by the next
//! run that looks into the folder ([`sweep`]). A lock says that its writer lives: the kernel takes it away with the process.

use crate::provenance;
use std::collections::BTreeSet;
use std::fs::{self, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;
use tempfile::NamedTempFile;

/// How the name of each begins.
const PREFIX: &str = ".partial-";

/// How old one must be where its lock proves nothing, since another kernel made it or the file system hands no locks around.
/// One is written within seconds.
const STALE: Duration = Duration::from_secs(24 * 3600);

/// Those of this process.
static UNDER_WAY: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// How the names of those begin that processes of this kernel make, where it says who it is.
static OWN_PREFIX: LazyLock<Option<String>> =
    LazyLock::new(|| Some(format!("{PREFIX}{}-", provenance::kernel()?)));

/// A file that is renamed into place, or vanishes.
pub(super) struct Partial {
    file: NamedTempFile,
    /// Goes with it.
    _listed: Listed,
}

/// An entry of [`UNDER_WAY`] that goes with its file.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}

impl Partial {
    /// Creates a new one in `directory`.
    pub(super) fn new(directory: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(OWN_PREFIX.as_deref().unwrap_or(PREFIX));
        // Others may read bundles and share stores: the temporary file's own mode would be for its owner only.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            builder.permissions(fs::Permissions::from_mode(0o644));
        }
        let mut under_way = UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let file = builder.tempfile_in(directory)?;
            // Whoever sweeps may have come between the making and the locking.
            let is_taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
            if !is_taken && file.path().exists() {
                let listed = Listed(file.path().to_owned());
                under_way.insert(listed.0.clone());
                return Ok(Self { file, _listed: listed });
            }
        }
    }

    /// Has it written piece by piece and makes that last.
    pub(super) fn write_with(
        &mut self,
        write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut out = BufWriter::with_capacity(1 << 16, self.file.as_file_mut());
        write(&mut out)?;
        out.flush()?;
        drop(out);
        self.file.as_file().sync_all()
    }

    /// Writes `bytes`, which last once [`Self::write_with`] has written what comes last.
    pub(super) fn begin(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    /// Renames it to `path`, whatever is there.
    pub(super) fn persist(self, path: &Path) -> io::Result<()> {
        self.file.persist(path).map(drop).map_err(|e| e.error)
    }
}

/// Removes everything that this process has unfinished, and does what comes `last` before anything else can be begun:
/// how an interrupted process ends.
pub fn abandon(last: impl FnOnce()) {
    let under_way = UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner);
    for path in &*under_way {
        let _ = fs::remove_file(path);
    }
    last();
}

/// Removes from `directory` what dead processes left unfinished. What cannot be read or removed stays: it disturbs
/// nobody.
pub(super) fn sweep(directory: &Path) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_partial = name.to_str().is_some_and(|name| name.starts_with(PREFIX));
        if is_partial && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let _ = remove_if_dead(&entry.path(), &name.to_string_lossy());
        }
    }
}

fn remove_if_dead(path: &Path, name: &str) -> io::Result<()> {
    // Network file systems lock only what is open for writing.
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    let is_own = OWN_PREFIX.as_deref().is_some_and(|own| name.starts_with(own));
    let is_dead = match file.try_lock() {
        Err(TryLockError::WouldBlock) => false,
        Ok(()) if is_own => true,
        Ok(()) | Err(TryLockError::Error(_)) => {
            provenance::age(file.metadata()?.modified()?) >= STALE
        }
    };
    if is_dead { fs::remove_file(path) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_the_dead_left_is_swept_and_the_work_of_the_living_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let live = Partial::new(folder.path()).unwrap();
        let write = |name: &str, old: bool| {
            fs::write(path(name), "half").unwrap();
            if old {
                let file = fs::File::options().write(true).open(path(name)).unwrap();
                file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
            }
        };
        write(".partial-another-kernel-s", false);
        write(".partial-another-kernel-s-of-long-ago", true);
        write("record.json", true);
        fs::create_dir(path(".partial-folder")).unwrap();
        let mut stays = vec![".partial-another-kernel-s".to_owned(), ".partial-folder".to_owned()];
        match OWN_PREFIX.as_deref() {
            Some(own) => write(&format!("{own}dead"), false),
            None => write(".partial-dead", true),
        }
        sweep(folder.path());
        let live_name = live.file.path().file_name().unwrap().to_str().unwrap().to_owned();
        stays.extend([live_name, "record.json".to_owned()]);
        stays.sort();
        assert_eq!(names(folder.path()), stays);
        live.persist(&path("whole")).unwrap();
        assert!(path("whole").exists());
        assert!(UNDER_WAY.lock().unwrap().iter().all(|p| !p.starts_with(folder.path())));
    }

    #[test]
    fn an_interrupted_process_leaves_nothing_under_way() {
        let folder = tempfile::tempdir().unwrap();
        let own = Partial::new(folder.path()).unwrap();
        let path = own.file.path().to_owned();
        // Other tests have work of their own under way: only this file is looked at.
        let listed = UNDER_WAY.lock().unwrap().contains(&path);
        assert!(listed && path.exists());
        drop(own);
        assert!(!path.exists());
        assert!(!UNDER_WAY.lock().unwrap().contains(&path));
    }
}
