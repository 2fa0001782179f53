//! What a program did to the disk, and what of it may be there after a power cut.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::os::unix::fs::{FileExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};

use crate::place::Files;
use crate::trace::{Action, Call, Watch};

/// Which file, whatever its names.
type File = usize;

/// What a name stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Node {
    Folder,
    File(File),
    Link(Vec<u8>),
}

/// One thing done to the disk. Paths count from the folder of the run.
#[derive(Clone, Debug)]
enum Act {
    Write(File, u64, Vec<u8>),
    Resize(File, u64),
    SyncFile(File),
    SyncFolder(PathBuf),
    Name(Naming),
}

/// A change of names; on the disk after a sync of a folder that it changes.
#[derive(Clone, Debug)]
struct Naming {
    /// This name goes ...
    gone: Option<PathBuf>,
    /// ... and this one comes.
    made: Option<(PathBuf, Node)>,
}

/// Records what a program does to the disk.
pub struct Recorder {
    root: PathBuf,
    /// Files at the beginning, all of them on the disk.
    first: Vec<(PathBuf, Node)>,
    contents: Vec<Vec<u8>>,
    acts: Vec<Act>,
    /// All names as they are now.
    names: BTreeMap<PathBuf, Node>,
    inodes: HashMap<u64, File>,
    count: usize,
    /// Whether the file of an `open` in progress was there before.
    was_there: HashMap<PathBuf, bool>,
}

/// What of the changes that were not synced is on the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    Nothing,
    Everything,
    /// A random part: the first ones and part of the next, or, of names, any.
    Part,
    /// Lengths, with zeros in the place of data.
    Zeros,
    /// Any of the others, for each file another.
    Any,
}

/// Random numbers that are the same every time (splitmix64).
pub struct Dice(pub u64);

impl Dice {
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % limit.max(1) as u64) as usize
    }
}

impl Recorder {
    /// For a run in `root`, which holds `files`.
    pub fn new(root: &Path, files: &Files) -> Self {
        let mut recorder = Recorder {
            root: root.to_path_buf(),
            first: Vec::new(),
            contents: Vec::new(),
            acts: Vec::new(),
            names: BTreeMap::new(),
            inodes: HashMap::new(),
            count: 0,
            was_there: HashMap::new(),
        };
        for (path, bytes) in files {
            let folders = path
                .ancestors()
                .skip(1)
                .filter(|p| !p.as_os_str().is_empty());
            let folders: Vec<_> = folders.map(Path::to_path_buf).collect();
            let new = |path: &PathBuf| !recorder.names.contains_key(path);
            for folder in folders.into_iter().rev().filter(new).collect::<Vec<_>>() {
                recorder.names.insert(folder, Node::Folder);
            }
            let node = match bytes.strip_prefix(b"-> ") {
                Some(to) => Node::Link(to.to_vec()),
                None => {
                    let file = recorder.file_at(&root.join(path));
                    recorder.contents.push(bytes.clone());
                    Node::File(file)
                }
            };
            recorder.names.insert(path.clone(), node);
        }
        recorder.first = recorder.names.clone().into_iter().collect();
        recorder
    }

    /// How many acts there are.
    pub fn len(&self) -> usize {
        self.acts.len()
    }

    /// A new file, under a path of the real file system.
    fn file_at(&mut self, path: &Path) -> File {
        let inode = fs::metadata(path).expect("it was made just now").ino();
        self.count += 1;
        self.inodes.insert(inode, self.count - 1);
        self.count - 1
    }

    /// The file that is open as `descriptor`; `None` for a folder.
    fn open_file(&self, call: &Call, descriptor: u64) -> Option<File> {
        let metadata = fs::metadata(call.open_file(descriptor)).expect("it is open");
        let file = metadata.is_file();
        file.then(|| {
            *self
                .inodes
                .get(&metadata.ino())
                .expect("a file that was seen")
        })
    }

    fn inside(&self, path: &Path) -> PathBuf {
        let inside = path.strip_prefix(&self.root);
        inside
            .expect("only calls below the root are seen")
            .to_path_buf()
    }

    fn name(&mut self, gone: Option<PathBuf>, made: Option<(PathBuf, Node)>) {
        let naming = Naming { gone, made };
        naming.apply(&mut self.names);
        self.acts.push(Act::Name(naming));
    }

    fn opened(&mut self, call: &Call, flags: u64) {
        let flags = flags as i32;
        if !self.was_there.remove(&call.path).unwrap_or(true) {
            let file = self.file_at(&call.path);
            self.contents.push(Vec::new());
            self.name(None, Some((self.inside(&call.path), Node::File(file))));
        } else if flags & libc::O_TRUNC != 0 {
            let inode = fs::metadata(&call.path).expect("it is open").ino();
            self.acts.push(Act::Resize(self.inodes[&inode], 0));
        }
    }

    fn written(&mut self, call: &Call, descriptor: u64, start: u64, length: usize) {
        let mut bytes = vec![0; length];
        let file = fs::File::open(call.open_file(descriptor)).expect("it is open");
        file.read_exact_at(&mut bytes, start)
            .expect("it was written");
        let file = self.open_file(call, descriptor).expect("a file");
        self.acts.push(Act::Write(file, start, bytes));
    }
}

impl Watch for Recorder {
    fn before(&mut self, call: &Call) -> Action {
        match call.name {
            "open" | "openat" => {
                let there = call.path.symlink_metadata().is_ok();
                self.was_there.insert(call.path.clone(), there);
                Action::Follow
            }
            "mmap" => {
                let shared = call.arguments[3] as i32 & libc::MAP_SHARED != 0;
                assert!(!shared, "the model does not know mapped files");
                Action::Pass
            }
            "write" | "pwrite64" | "writev" | "copy_file_range" | "fsync" | "fdatasync"
            | "ftruncate" | "mkdir" | "rmdir" | "unlink" | "unlinkat" | "symlink" | "link"
            | "linkat" | "rename" | "renameat" | "renameat2" => Action::Follow,
            "creat" | "openat2" | "pwritev" | "pwritev2" | "sendfile" | "truncate"
            | "fallocate" | "mkdirat" | "symlinkat" => {
                panic!("the model does not know {}", call.name)
            }
            _ => Action::Pass,
        }
    }

    fn after(&mut self, call: &Call, result: i64) {
        if result < 0 {
            return;
        }
        let arguments = call.arguments;
        let path = self.inside(&call.path);
        match call.name {
            "open" => self.opened(call, arguments[1]),
            "openat" => self.opened(call, arguments[2]),
            "write" | "writev" => {
                let start = call.position(arguments[0]) - result as u64;
                self.written(call, arguments[0], start, result as usize);
            }
            "copy_file_range" => {
                let start = call.position(arguments[2]) - result as u64;
                self.written(call, arguments[2], start, result as usize);
            }
            "pwrite64" => self.written(call, arguments[0], arguments[3], result as usize),
            "ftruncate" => {
                let file = self.open_file(call, arguments[0]).expect("a file");
                self.acts.push(Act::Resize(file, arguments[1]));
            }
            "fsync" | "fdatasync" => self.acts.push(match self.open_file(call, arguments[0]) {
                Some(file) => Act::SyncFile(file),
                None => Act::SyncFolder(path),
            }),
            "mkdir" => self.name(None, Some((path, Node::Folder))),
            "rmdir" | "unlink" | "unlinkat" => self.name(Some(path), None),
            "symlink" => {
                let to = fs::read_link(&call.path).expect("it was made just now");
                let to = to.into_os_string().into_encoded_bytes();
                self.name(None, Some((path, Node::Link(to))));
            }
            _ => {
                let to = self.inside(call.to.as_ref().expect("it has two paths"));
                let node = self.names[&path].clone();
                let gone = call.name.starts_with("rename").then_some(path);
                self.name(gone, Some((to, node)));
            }
        }
    }
}

impl Naming {
    fn apply(&self, names: &mut BTreeMap<PathBuf, Node>) {
        let Some(gone) = &self.gone else {
            if let Some((path, node)) = &self.made {
                names.insert(path.clone(), node.clone());
            }
            return;
        };
        names.remove(gone);
        let below = names.keys().filter(|path| path.starts_with(gone));
        let below: Vec<_> = below.cloned().collect();
        for path in below {
            let node = names.remove(&path).expect("it was listed just now");
            if let Some((made, _)) = &self.made {
                let rest = path.strip_prefix(gone).expect("it is below");
                names.insert(made.join(rest), node);
            }
        }
        if let Some((made, node)) = &self.made {
            names.insert(made.clone(), node.clone());
        }
    }

    fn changes(&self, folder: &Path) -> bool {
        let made = self.made.as_ref().map(|(path, _)| path);
        let mut paths = self.gone.iter().chain(made);
        paths.any(|path| path.parent() == Some(folder))
    }
}

/// A file: what is surely on the disk, and what was done since.
#[derive(Clone, Default)]
struct Content {
    synced: Vec<u8>,
    later: Vec<(u64, Option<Vec<u8>>)>,
}

impl Content {
    fn apply(bytes: &mut Vec<u8>, (start, data): &(u64, Option<Vec<u8>>)) {
        let start = *start as usize;
        match data {
            None => bytes.resize(start, 0),
            Some(data) => {
                bytes.resize(bytes.len().max(start + data.len()), 0);
                bytes[start..start + data.len()].copy_from_slice(data);
            }
        }
    }

    fn sync(&mut self) {
        for change in std::mem::take(&mut self.later) {
            Content::apply(&mut self.synced, &change);
        }
    }

    fn after_power_cut(&self, kept: Kept, dice: &mut Dice) -> Vec<u8> {
        const ALL: [Kept; 4] = [Kept::Nothing, Kept::Everything, Kept::Part, Kept::Zeros];
        let mut bytes = self.synced.clone();
        match kept {
            Kept::Nothing => {}
            Kept::Everything => self
                .later
                .iter()
                .for_each(|c| Content::apply(&mut bytes, c)),
            Kept::Zeros => {
                for (start, data) in &self.later {
                    let zeros = data.as_ref().map(|data| vec![0; data.len()]);
                    Content::apply(&mut bytes, &(*start, zeros));
                }
            }
            Kept::Part => {
                let whole = dice.below(self.later.len() + 1);
                self.later[..whole]
                    .iter()
                    .for_each(|c| Content::apply(&mut bytes, c));
                if let Some((start, Some(data))) = self.later.get(whole) {
                    let part = data[..dice.below(data.len())].to_vec();
                    Content::apply(&mut bytes, &(*start, Some(part)));
                }
            }
            Kept::Any => return self.after_power_cut(ALL[dice.below(4)], dice),
        }
        bytes
    }
}

impl Recorder {
    /// The files that may be there if the power fails after `count` acts.
    pub fn power_cut(&self, count: usize, names: Kept, data: Kept, seed: u64) -> Files {
        let mut dice = Dice(seed);
        let with = |bytes: &Vec<u8>| Content {
            synced: bytes.clone(),
            later: Vec::new(),
        };
        let mut contents: Vec<_> = self.contents.iter().map(with).collect();
        let mut namings: Vec<(&Naming, bool)> = Vec::new();
        for act in &self.acts[..count] {
            match act {
                Act::Write(file, start, bytes) => {
                    contents[*file].later.push((*start, Some(bytes.clone())));
                }
                Act::Resize(file, length) => contents[*file].later.push((*length, None)),
                Act::SyncFile(file) => contents[*file].sync(),
                Act::SyncFolder(folder) => {
                    for (naming, synced) in &mut namings {
                        *synced |= naming.changes(folder);
                    }
                }
                Act::Name(naming) => namings.push((naming, false)),
            }
        }
        let mut tree: BTreeMap<_, _> = self.first.iter().cloned().collect();
        for (naming, synced) in namings {
            let there = match names {
                Kept::Nothing => false,
                Kept::Everything => true,
                _ => dice.below(2) == 0,
            };
            if synced || there {
                naming.apply(&mut tree);
            }
        }
        let mut files = Files::new();
        for (path, node) in &tree {
            let above = path
                .ancestors()
                .skip(1)
                .filter(|p| !p.as_os_str().is_empty());
            if above
                .into_iter()
                .any(|folder| tree.get(folder) != Some(&Node::Folder))
            {
                continue;
            }
            let bytes = match node {
                Node::Folder => continue,
                Node::Link(to) => [b"-> ", to.as_slice()].concat(),
                Node::File(file) => contents[*file].after_power_cut(data, &mut dice),
            };
            files.insert(path.clone(), bytes);
        }
        files
    }
}
