//! Files: the only user of the file system besides the command line. Everything is written whole or not at all.

mod directory;
mod gc;
mod lines;
mod pack;
mod partial;
mod prune;
mod scratch;
mod segments;

pub use directory::{DirectoryStore, Looked};
pub use gc::Collected;
pub use lines::{Audit, Damage};
pub use pack::{Imported, PackError, check_pack};
pub use partial::abandon;
pub use prune::Pruned;
pub use scratch::{DiskScratch, room};

use crate::bundle::{Archive, Content, Fault, Source, archive};
use fs_err as fs;
use partial::Partial;
use scratch::InFile;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Says what went wrong, without the numbers of one operating system.
pub fn reason(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::NotFound => "no such file".to_owned(),
        Kind::PermissionDenied => "no permission".to_owned(),
        Kind::IsADirectory => "it is a folder".to_owned(),
        Kind::NotADirectory => "a part of its path is a file".to_owned(),
        Kind::ReadOnlyFilesystem => "the file system is for reading only".to_owned(),
        Kind::StorageFull => "the disk is full".to_owned(),
        Kind::QuotaExceeded => "the quota of this disk is used up".to_owned(),
        _ => error.to_string(),
    }
}

/// Removes a folder that this command made, with whatever is in it. What cannot be removed stays.
pub fn discard(folder: &Path) {
    let _ = fs::remove_dir_all(folder);
}

/// Returns whether `folder` is a folder in which nothing lies.
///
/// # Errors
/// Where it cannot be read, or is none.
pub fn holds_nothing(folder: &Path) -> io::Result<bool> {
    Ok(fs::read_dir(folder)?.next().is_none())
}

/// Publishes what `write` writes as `directory/name`: written beside it, made durable, renamed. A reader sees the old file or the
/// new one, never a part.
///
/// # Errors
/// Where the file system refuses, or `write` fails.
pub fn publish(
    directory: &Path,
    name: &str,
    write: impl FnOnce(&mut io::BufWriter<&mut std::fs::File>) -> io::Result<()>,
) -> io::Result<PathBuf> {
    fs::create_dir_all(directory)?;
    let path = directory.join(name);
    partial::sweep(directory);
    let mut file = Partial::new(directory)?;
    file.write_with(write)?;
    file.persist(&path)?;
    sync_folder(directory)?;
    Ok(path)
}

/// Makes a rename last through a power cut. Windows has no such call and needs none.
fn sync_folder(directory: &Path) -> io::Result<()> {
    if cfg!(unix) { fs::File::open(directory)?.sync_all() } else { Ok(()) }
}

/// Reads an input file of at most `most` bytes: a file on a disk, for a device has no end and a pipe may never begin.
///
/// # Errors
/// Where it cannot be read, is no such file or too large, naming it.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Asked before it is opened: a socket cannot be, and a device may do something.
    if let Some(found) = kind_of(path) {
        return Err(no_file(found));
    }
    content(path, most)?.map_err(|length| {
        let found = length.map_or_else(|| "more".to_owned(), |length| length.to_string());
        let problem = format!("it is too large: expected at most {most} bytes, found {found}");
        io::Error::new(io::ErrorKind::FileTooLarge, problem)
    })
}

fn no_file(found: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("expected a file, found {found}"))
}

/// Reads the bytes of the file at `path`; where they are more than `most`, returns how many, as far as the file says.
fn content(path: &Path, most: u64) -> io::Result<Result<Vec<u8>, Option<u64>>> {
    let file = open(path)?;
    let metadata = file.metadata()?;
    // Or it is another thing by now.
    if let Some(found) = odd(&metadata) {
        return Err(no_file(found));
    }
    if metadata.len() > most {
        return Ok(Err(Some(metadata.len())));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
    // It may have grown meanwhile, and some files say nothing of their length.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(if bytes.len() as u64 > most { Err(None) } else { Ok(bytes) })
}

/// Opens a file to read it. Should a pipe have taken its place meanwhile, that does not wait for whoever writes to it.
fn open(path: &Path) -> io::Result<fs::File> {
    let mut options = fs::OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use fs_err::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(libc::O_NONBLOCK);
    }
    options.open(path)
}

/// Returns what stands at `path`, where it is something that is no file.
fn kind_of(path: &Path) -> Option<&'static str> {
    let leads_nowhere = || {
        let link = fs::symlink_metadata(path).ok()?;
        link.is_symlink().then_some("a symbolic link that leads nowhere")
    };
    match fs::metadata(path) {
        Ok(metadata) => odd(&metadata),
        Err(e) if e.kind() == io::ErrorKind::PermissionDenied => None,
        Err(_) => leads_nowhere(),
    }
}

/// Says in words what `metadata` describes, where it is no file.
fn odd(metadata: &std::fs::Metadata) -> Option<&'static str> {
    let kind = metadata.file_type();
    if kind.is_file() {
        return None;
    }
    if kind.is_dir() {
        return Some("a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    Some("a device")
}

/// Opens a bundle: a zip, or a folder that holds a bag or a crate. What is wrong with it is data, not an error.
///
/// # Errors
/// Where the path cannot be read at all.
pub fn open_bundle(
    path: &Path,
    limits: &archive::Limits,
) -> io::Result<Result<Archive, Vec<Fault>>> {
    let too_big = |found: Option<u64>| {
        let expected = format!("at most {} bytes", limits.bytes);
        let found = found.map_or_else(|| "more".to_owned(), |bytes| format!("{bytes} bytes"));
        Err(vec![Fault::new("(archive)", expected, found).hint(archive::TOO_LARGE)])
    };
    let metadata = fs::metadata(path)?;
    if !metadata.is_dir() {
        if !metadata.is_file() {
            return Ok(Err(vec![Fault::new(
                "(archive)",
                "a file or a folder",
                "a device or a pipe",
            )]));
        }
        let file = open(path)?;
        let metadata = file.metadata()?;
        if let Some(found) = odd(&metadata) {
            return Err(no_file(found));
        }
        if metadata.len() > limits.bytes {
            return Ok(too_big(Some(metadata.len())));
        }
        let source: Arc<dyn Source> = Arc::new(InFile(file.into_parts().0));
        return archive::read_from(&source, metadata.len(), limits);
    }
    let (mut files, mut faults, mut total, mut held, mut entries) =
        (Vec::new(), Vec::new(), 0, 0, 0);
    let mut folders = vec![(path.to_owned(), String::new())];
    while let Some((folder, prefix)) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            // Folders count as well: there may be no end of empty ones.
            entries += 1;
            if entries > limits.entries {
                let expected = format!("at most {} files and folders", limits.entries);
                return Ok(Err(vec![Fault::new("(archive)", expected, "more")]));
            }
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type()?;
            if kind.is_dir() {
                // Its entry says that it is there, should nothing be in it.
                files.push((format!("{name}/"), Content::Held(Vec::new())));
                folders.push((entry.path(), format!("{name}/")));
            } else if kind.is_file() {
                let file = open(&entry.path())?;
                let length = file.metadata()?.len();
                total += length;
                if total > limits.bytes {
                    return Ok(too_big(Some(total)));
                }
                let source = Arc::new(InFile(file.into_parts().0));
                let file = archive::file_of_folder(&name, source, length)?;
                held += file.as_file().held().map_or(0, |bytes| bytes.len() as u64);
                if held > limits.held {
                    let expected = format!(
                        "at most {} bytes beside records and tables of trials",
                        limits.held
                    );
                    return Ok(Err(vec![Fault::new("(archive)", expected, "more")]));
                }
                files.push((name, file));
            } else {
                let found = if kind.is_symlink() { "a symbolic link" } else { "a special file" };
                faults.push(Fault::new(name, "a plain file", found));
            }
        }
    }
    if faults.is_empty() {
        Ok(archive::from_files(files, limits))
    } else {
        faults.sort();
        Ok(Err(archive::told(faults)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::{Form, Limits, sample};
    use std::io::Write as _;

    #[test]
    fn bundles_are_published_whole_and_opened_as_zip_or_folder() {
        let directory = tempfile::tempdir().unwrap();
        let sealed = sample::sealed();
        let zip = sealed.zip(Form::Bag);
        let out = directory.path().join("out");
        let seal = || publish(&out, &sealed.file_name(), |file| file.write_all(&zip));
        let path = seal().unwrap();
        seal().unwrap();
        assert_eq!(fs::read_dir(directory.path().join("out")).unwrap().count(), 1);
        let opened = open_bundle(&path, &Limits::default()).unwrap().unwrap();
        assert_eq!(opened.tree, sealed.tree);

        let folder = directory.path().join("folder");
        for (path, bytes) in &sealed.tree {
            fs::create_dir_all(folder.join(path).parent().unwrap()).unwrap();
            fs::write(folder.join(path), bytes).unwrap();
        }
        let opened = open_bundle(&folder, &Limits::default()).unwrap().unwrap();
        assert_eq!(opened.tree, sealed.tree);
        let small = Limits { bytes: 1000, ..Limits::default() };
        let faults = open_bundle(&path, &small).unwrap().unwrap_err();
        assert!(
            faults[0].to_string().starts_with("(archive): expected at most 1000 bytes, found ")
        );
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("/etc/passwd", folder.join("data/link")).unwrap();
            let faults = open_bundle(&folder, &Limits::default()).unwrap().unwrap_err();
            assert_eq!(
                faults[0].to_string(),
                "data/link: expected a plain file, found a symbolic link"
            );
        }
        #[cfg(unix)]
        {
            let endless = open_bundle(Path::new("/dev/zero"), &Limits::default()).unwrap();
            let fault = endless.unwrap_err()[0].to_string();
            assert_eq!(fault, "(archive): expected a file or a folder, found a device or a pipe");
        }
        assert!(open_bundle(&directory.path().join("absent"), &Limits::default()).is_err());
    }
}
