//! Checks of a file of unknown origin before its parts are read: libhdf5 follows links into other
//! files, and what a file claims to hold is not bounded by its size.

use super::{scales, watch};
use hdf5::plist::dataset_create::Layout;
use hdf5::plist::file_access::FileAccessBuilder;
use hdf5::types::TypeDescriptor;
use hdf5::{Container, Dataset, File, Group, H5Type, IndexType, IterationOrder, LinkType};
use std::fs::TryLockError;
use std::path::Path;
use std::sync::LazyLock;

/// Bytes that a byte of a file can hold at most: deflate makes no more of one.
const LARGEST_EXPANSION: u64 = 1032;
/// The beginning of every HDF5 file, where nothing is prepended to it.
pub(super) const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Refuses to go on where libhdf5 does not start, as it does not with drivers, connectors or plugins that it
/// cannot find.
///
/// # Errors
/// The message says which variables of the environment may be why.
pub(super) fn require_start() -> Result<(), String> {
    static STARTS: LazyLock<bool> = LazyLock::new(scales::starts);
    if *STARTS {
        return Ok(());
    }
    let is_set = |name: &&str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let set: Vec<&str> = VARIABLES.into_iter().filter(is_set).collect();
    Err(match &set[..] {
        [] => "HDF5 does not start".to_owned(),
        set => format!("HDF5 does not start: unset {} in the environment", set.join(", ")),
    })
}

/// Variables that have libhdf5 begin with something that it may not find.
const VARIABLES: [&str; 4] = ["HDF5_DRIVER", "HDF5_VOL_CONNECTOR", "HDF5_PLUGIN_PRELOAD", "HDF5_PLUGIN_PATH"];

/// The way in which all files are opened, whatever the environment says: plain reads and writes of one file,
/// without a lock.
pub(super) fn access(access: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    access.sec2().file_locking(false)
}

/// The way in which files are opened for writing. Nothing is kept of a dataset when it is closed, so that every error is one of
/// the write: where libhdf5 fails to close a dataset, it frees it but keeps its identifier, and the program ends by a signal
/// when the file is closed.
pub(super) fn write_access(builder: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    access(builder).chunk_cache(0, 0, 1.0).sieve_buf_size(0)
}

/// An HDF5 file for reading, without a lock of its own: files are replaced as a whole here, and locks of
/// readers hinder others.
///
/// # Errors
/// The reason why libhdf5 does not open it, or that another program has it open for writing.
pub(crate) fn open(path: &Path) -> Result<File, String> {
    require_start()?;
    if path.to_str().is_none() {
        return Err("cannot be read: its name is not UTF-8, which HDF5 needs; rename it".to_owned());
    }
    if is_locked(path) {
        return Err(
            "is locked: another program has it open for writing; close it there, or read a copy".to_owned()
        );
    }
    watch::opened(path);
    File::with_options().with_fapl(access).open(path).map_err(|_| not_opened(path))
}

/// Whether a file has the lock that libhdf5 takes for writing, unless its users have turned locks off as
/// libhdf5 lets them.
fn is_locked(path: &Path) -> bool {
    let are_off =
        std::env::var_os("HDF5_USE_FILE_LOCKING").is_some_and(|value| value == "FALSE" || value == "0");
    let lock = std::fs::File::open(path).map(|file| file.try_lock_shared());
    !are_off && matches!(lock, Ok(Err(TryLockError::WouldBlock)))
}

/// The reason why libhdf5 does not open a file.
fn not_opened(path: &Path) -> String {
    use std::io::Read;
    let mut beginning = [0; 8];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut beginning));
    if read.is_ok() && beginning == SIGNATURE {
        "is an HDF5 file that is damaged or incomplete".to_owned()
    } else {
        "is not an HDF5 file".to_owned()
    }
}

/// The group of that name, or the root for `/`, if it is in the file itself.
///
/// # Errors
/// The message says what is there instead.
pub(super) fn group(file: &File, path: &str) -> Result<Group, String> {
    let missing = || format!("lacks the group /{}", path.trim_start_matches('/'));
    let root = file.as_group().map_err(|_| missing())?;
    names(path).try_fold(root, |group, name| {
        if !held(&group, name)? {
            return Err(missing());
        }
        group.group(name).map_err(|_| missing())
    })
}

/// The dataset of that path, if it and its values are in the file itself.
///
/// # Errors
/// The message says what is there instead.
pub(crate) fn dataset(file: &File, path: &str) -> Result<Dataset, String> {
    let missing = || format!("lacks the dataset {path}");
    let (parent, name) =
        path.trim_start_matches('/').rsplit_once('/').unwrap_or(("", path.trim_start_matches('/')));
    let parent = group(file, parent)?;
    if !held(&parent, name)? {
        return Err(missing());
    }
    let dataset = parent.dataset(name).map_err(|_| missing())?;
    let creation = dataset.dcpl().map_err(|_| format!("has a dataset {path} that cannot be read"))?;
    let layout = creation.get_layout().unwrap_or(Layout::Virtual);
    // Asked for only where there can be any: of other layouts libhdf5 knows no external files.
    let external = matches!(layout, Layout::Contiguous)
        && creation.get_external().map_or(true, |files| !files.is_empty());
    if external || matches!(layout, Layout::Virtual) {
        return Err(format!("has a dataset {path} whose values are in other files, which are not read"));
    }
    Ok(dataset)
}

fn names(path: &str) -> impl Iterator<Item = &str> {
    path.split('/').filter(|name| !name.is_empty())
}

/// Whether a group has a member; not so if it is only a link to elsewhere.
fn held(group: &Group, name: &str) -> Result<bool, String> {
    let find = |known: &str, link: hdf5::LinkInfo| Ok((known == name).then_some(link.link_type));
    match group.find_link(IndexType::Name, IterationOrder::Native, find) {
        Ok(Some(LinkType::Hard)) => Ok(true),
        Ok(Some(_)) => Err(format!("has a link `{name}` to elsewhere in place of what is asked for")),
        Ok(None) => Ok(false),
        Err(_) => Err(format!("is damaged where `{name}` is looked for")),
    }
}

/// Refuses a dataset or attribute with more values than a file of `bytes` bytes can hold.
///
/// # Errors
/// The message says what it claims.
pub(crate) fn fits(container: &Container, bytes: u64) -> Result<(), String> {
    let element = container.dtype().map_or(u64::MAX, |dtype| dtype.size() as u64);
    let claimed =
        container.shape().iter().try_fold(element, |product, &length| product.checked_mul(length as u64));
    let stored = container.storage_size().min(bytes);
    match claimed {
        Some(claimed) if claimed <= stored.saturating_mul(LARGEST_EXPANSION) => Ok(()),
        _ => Err("has more values than the file holds".to_owned()),
    }
}

/// Refuses a dataset or attribute whose values are of another kind than `T`: texts or compounds in place of
/// numbers, fractions in place of whole numbers.
///
/// # Errors
/// The message says what it holds.
pub(crate) fn is_kind_of<T: H5Type>(container: &Container) -> Result<(), String> {
    let whole = |descriptor: &TypeDescriptor| match descriptor {
        TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_) => Some(true),
        TypeDescriptor::Float(_) => Some(false),
        _ => None,
    };
    let needed = whole(&T::type_descriptor());
    match container.dtype().and_then(|dtype| dtype.to_descriptor()) {
        Ok(found) if whole(&found) == needed => Ok(()),
        _ => Err(format!("does not hold {}", if needed == Some(true) { "whole numbers" } else { "numbers" })),
    }
}
