//! Directories from which the compiler resolves the file names in a text.

use super::files::{directory, is_absolute, reduced};

/// Directories of a text.
#[derive(Clone)]
pub(super) struct Place {
    /// Directory of the text's model, followed by the directories of the models that have it as an
    /// asset: for an asset of a child, the compilers of 3.2 use the directory of the parent. A
    /// directory has a trailing slash or is empty, which is the working directory of the process.
    models: Vec<Vec<u8>>,
    /// Directories of the included file that contains the text, with and without the model's
    /// directory. Empty for the main text of a model.
    included: Vec<Vec<u8>>,
}

/// Path at which the compiler may find a text.
#[derive(Clone)]
pub(super) struct Candidate {
    pub(super) path: Vec<u8>,
    /// The path relative to the directory of the model.
    name: Vec<u8>,
}

impl Place {
    pub(super) fn new(directory: &[u8]) -> Self {
        Self { models: vec![directory.to_owned()], included: Vec::new() }
    }

    /// Returns the place of an included text.
    pub(super) fn of_include(&self, found: &Candidate) -> Self {
        let mut included = vec![directory(&found.path).to_owned(), directory(&found.name).to_owned()];
        if cfg!(not(engine_since = "3.2.0")) {
            // These compilers append the directory to the directory of the file that includes this
            // one.
            let outer = self.included.first().unwrap_or(&self.models[0]);
            included.push([outer, directory(&found.path)].concat());
        }
        included.dedup();
        Self { models: self.models.clone(), included }
    }

    /// Returns the place of a model that the text has as an asset.
    pub(super) fn of_model(&self, found: &Candidate) -> Self {
        let directory = directory(&found.path);
        let outer = self.models.iter().filter(|known| *known != directory).cloned();
        let models = std::iter::once(directory.to_owned()).chain(outer).collect();
        Self { models, included: Vec::new() }
    }

    /// Returns the paths at which the compiler may find an included text or another model. Newer
    /// compilers look first in the directory of the model, and then in the directory of the
    /// included file with the name.
    pub(super) fn texts(&self, name: &[u8]) -> Vec<Candidate> {
        let [directory, ..] = &self.models[..] else { return Vec::new() };
        // The compiler of 2.2.2 appends the name to the directory even if the name is absolute.
        let plain = Candidate { path: [directory, name].concat(), name: name.to_owned() };
        let mut candidates = vec![plain];
        if cfg!(not(engine_since = "2.3.0")) {
            return candidates;
        }
        let once = self.names(name);
        let twice = once.iter().flat_map(|name| self.names(name));
        for name in twice {
            let path = joined(directory, &name);
            for path in [reduced(&path), path] {
                if candidates.iter().all(|known| known.path != path) {
                    candidates.push(Candidate { path, name: name.clone() });
                }
            }
        }
        candidates
    }

    /// Returns the path of an asset in the directory of the model, and in a directory that the text
    /// specifies.
    pub(super) fn asset(&self, folder: &[u8], name: &[u8]) -> Vec<u8> {
        in_folder(&self.models[0], folder, name)
    }

    /// Returns the paths at which some version of the compiler looks for an asset, which may be
    /// relative to a directory that the text specifies.
    pub(super) fn assets(&self, folder: &[u8], name: &[u8]) -> Vec<Vec<u8>> {
        if cfg!(not(engine_since = "2.3.0")) {
            return vec![self.asset(folder, name)];
        }
        let names = self.names(name);
        let pairs = self.models.iter().flat_map(|directory| names.iter().map(move |name| (directory, name)));
        let mut paths: Vec<Vec<u8>> = pairs
            .flat_map(|(directory, name)| {
                let path = in_folder(directory, folder, name);
                // Newer compilers treat a name with a drive as relative on Unix.
                let relative = [directory, folder, b"/", name].concat();
                [reduced(&path), reduced(&relative), path]
            })
            .collect();
        paths.sort_unstable();
        paths.dedup();
        paths
    }

    /// Returns a name, and the same name in the directories of the included file.
    fn names(&self, name: &[u8]) -> Vec<Vec<u8>> {
        let inside = self.included.iter().map(|directory| joined(directory, name));
        let mut names = vec![name.to_owned()];
        for name in inside {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

/// Appends a name to a directory, unless the name is absolute.
fn joined(directory: &[u8], name: &[u8]) -> Vec<u8> {
    let slash: &[u8] = if matches!(directory.last(), None | Some(b'/' | b'\\')) { b"" } else { b"/" };
    if is_absolute(name) { name.to_owned() } else { [directory, slash, name].concat() }
}

/// Returns the path of an asset in a folder of a model's directory.
fn in_folder(directory: &[u8], folder: &[u8], name: &[u8]) -> Vec<u8> {
    joined(directory, &joined(folder, name))
}

#[cfg(test)]
mod tests {
    use super::Place;

    #[test]
    #[cfg_attr(not(engine_since = "2.3.0"), ignore = "2.2.2 looks only in the directory of the model")]
    fn a_text_in_another_directory_is_looked_up_there_too() {
        let paths = |place: &Place, name: &[u8]| -> Vec<String> {
            place.texts(name).into_iter().map(|found| String::from_utf8(found.path).unwrap()).collect()
        };
        let main = Place::new(b"/models/");
        assert_eq!(paths(&main, b"parts/arm.xml"), ["/models/parts/arm.xml"]);
        let arm = &main.texts(b"parts/arm.xml")[0];
        let included = main.of_include(arm);
        let names = paths(&included, b"hand.xml");
        assert!(names.contains(&"/models/hand.xml".to_owned()), "{names:?}");
        assert!(names.contains(&"/models/parts/hand.xml".to_owned()), "{names:?}");
        assert!(paths(&main, b"/other/arm.xml").contains(&"/other/arm.xml".to_owned()));
        assert_eq!(paths(&main.of_model(arm), b"hand.xml"), ["/models/parts/hand.xml"]);

        let assets = |place: &Place| -> Vec<String> {
            place.assets(b"meshes", b"a.obj").into_iter().map(|path| String::from_utf8(path).unwrap()).collect()
        };
        assert_eq!(assets(&main), ["/models/meshes/a.obj"]);
        assert!(assets(&included).contains(&"/models/parts/a.obj".to_owned()), "{:?}", assets(&included));
        assert!(assets(&main.of_model(arm)).contains(&"/models/parts/meshes/a.obj".to_owned()));
    }
}
