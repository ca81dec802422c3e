//! Places on a disk for what does not fit into memory, and files that are read in place.

use crate::bundle::{Scratch, Source};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A file that is read at any place.
#[derive(Debug)]
pub(super) struct InFile(pub(super) File);

impl Source for InFile {
    #[cfg(unix)]
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(&self.0, into, at)
    }

    #[cfg(windows)]
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        std::os::windows::fs::FileExt::seek_read(&self.0, into, at)
    }

    #[cfg(not(any(unix, windows)))]
    fn read_at(&self, _: u64, _: &mut [u8]) -> io::Result<usize> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Returns how many bytes can still be written to `folder`, which need not be there yet; `None` where the system does not say.
pub fn room(folder: &Path) -> Option<u64> {
    let absolute = std::path::absolute(folder).ok()?;
    let there = absolute.ancestors().find(|folder| folder.is_dir())?;
    #[cfg(unix)]
    {
        let told = rustix::fs::statvfs(there).ok()?;
        told.f_bavail.checked_mul(told.f_frsize)
    }
    #[cfg(not(unix))]
    {
        let _ = there;
        None
    }
}

/// A scratch in a folder, which is made when something is written first. The file has no name where the system can do without, and
/// is gone with the process.
#[derive(Debug)]
pub struct DiskScratch {
    folder: PathBuf,
    file: OnceLock<Arc<InFile>>,
    length: Mutex<u64>,
}

impl DiskScratch {
    /// Creates one in `folder`.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), file: OnceLock::new(), length: Mutex::new(0) }
    }

    fn file(&self) -> io::Result<&Arc<InFile>> {
        if self.file.get().is_none() {
            fs::create_dir_all(&self.folder)?;
            let file = tempfile::tempfile_in(&self.folder)?;
            let _ = self.file.set(Arc::new(InFile(file)));
        }
        self.file.get().ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

impl Scratch for DiskScratch {
    fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        let mut length = self.length.lock().unwrap_or_else(PoisonError::into_inner);
        // Nothing else moves the place where it is written.
        (&self.file()?.0).write_all(bytes)?;
        let from = *length;
        *length += bytes.len() as u64;
        Ok(from)
    }

    fn source(&self) -> Arc<dyn Source> {
        match self.file() {
            Ok(file) => Arc::<InFile>::clone(file),
            // Nothing was written: there is nothing to read.
            Err(_) => Arc::new(Vec::<u8>::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::{Content, Spool};
    use std::io::Read as _;

    #[test]
    fn room_is_that_of_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let room = room(&folder.path().join("not/yet"));
        assert_eq!(room.is_some(), cfg!(unix));
        assert!(room.is_none_or(|room| room > 0));
    }

    #[test]
    fn what_is_too_large_for_memory_is_read_from_a_disk() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = DiskScratch::in_folder(&folder.path().join("out"));
        let mut spooled = Vec::new();
        for letter in ["a", "b"] {
            let mut spool = Spool::new(&scratch);
            for _ in 0..3 {
                spool.write_all(letter.repeat(1 << 20).as_bytes()).unwrap();
            }
            spooled.push(spool.finish().unwrap());
        }
        for (content, letter) in spooled.iter().zip(["a", "b"]) {
            let Content::Large(file) = content else { panic!("3 MiB in memory") };
            let mut text = String::new();
            file.reader().read_to_string(&mut text).unwrap();
            assert!(text == letter.repeat(3 << 20));
        }
        // Windows keeps a name until the process is gone.
        #[cfg(unix)]
        assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 0);
        let small = Spool::new(&DiskScratch::in_folder(Path::new("/nowhere"))).finish().unwrap();
        assert_eq!(small, Content::Held(Vec::new()));
    }
}
