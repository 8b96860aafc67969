//! Circular dependencies between the files of a crate.

use std::collections::{BTreeMap, BTreeSet};

use crate::module_tree::{ModuleId, ModuleTree, Sources};

/// Names that files of a crate use of each other, as `uses[user][used]`.
pub type Uses = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// Target of a name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Module(ModuleId),
    /// Item of a module, by its name there.
    Item(ModuleId, String),
}

/// Finds out which file uses which names of which other one: every path is followed, through re-exports, to the file that
/// defines the item. Naming a module alone, declaring it or re-exporting from it does not count as a use.
pub fn uses(sources: &Sources, root: &str) -> Uses {
    let tree = ModuleTree::read(sources, root);
    let mut uses = Uses::new();
    for (id, module) in tree.modules.iter().enumerate() {
        let imports = module.imports.iter().filter(|import| !import.is_reexport).map(|import| &import.path);
        for path in imports.chain(&module.mentions) {
            for target in tree.resolve(id, path, &mut BTreeSet::new()) {
                let Target::Item(defining, name) = target else { continue };
                let used = &tree.modules[defining].file;
                if *used != module.file {
                    let names = uses.entry(module.file.clone()).or_default().entry(used.clone()).or_default();
                    names.insert(name);
                }
            }
        }
    }
    uses
}

impl ModuleTree {
    /// Returns everything that a path may mean in a module, since a name can be a module and a function at once. The
    /// result is empty for items of other crates. `trail` holds the names being resolved, since re-exports may be
    /// circular.
    fn resolve(
        &self,
        from: ModuleId,
        path: &[String],
        trail: &mut BTreeSet<(ModuleId, String)>,
    ) -> BTreeSet<Target> {
        let Some((first, rest)) = path.split_first() else { return BTreeSet::new() };
        let mut targets = match first.as_str() {
            "crate" => BTreeSet::from([Target::Module(0)]),
            "self" => BTreeSet::from([Target::Module(from)]),
            "super" => self.modules[from].parent.map(Target::Module).into_iter().collect(),
            name => self.look_up(from, name, trail),
        };
        for name in rest {
            // A name with further segments means the module rather than the function of that name.
            if targets.iter().any(|target| matches!(target, Target::Module(_))) {
                targets.retain(|target| matches!(target, Target::Module(_)));
            }
            let next = targets.into_iter().map(|target| match target {
                Target::Module(id) if name == "super" => {
                    self.modules[id].parent.map(Target::Module).into_iter().collect()
                }
                Target::Module(id) => self.look_up(id, name, trail),
                // A variant or an associated item is defined where its type is.
                item @ Target::Item(..) => BTreeSet::from([item]),
            });
            targets = next.collect::<Vec<_>>().into_iter().flatten().collect();
        }
        targets
    }

    fn look_up(
        &self,
        module: ModuleId,
        name: &str,
        trail: &mut BTreeSet<(ModuleId, String)>,
    ) -> BTreeSet<Target> {
        let step = (module, name.to_owned());
        if !trail.insert(step.clone()) {
            return BTreeSet::new();
        }
        let here = &self.modules[module];
        let mut targets: BTreeSet<Target> =
            here.children.get(name).copied().map(Target::Module).into_iter().collect();
        if here.items.contains(name) {
            targets.insert(Target::Item(module, name.to_owned()));
        }
        for import in here.imports.iter().filter(|import| import.name == name) {
            targets.extend(self.resolve(module, &import.path, trail));
        }
        if targets.is_empty() {
            for import in here.imports.iter().filter(|import| import.name == "*") {
                for target in self.resolve(module, &import.path, trail) {
                    if let Target::Module(opened) = target {
                        targets.extend(self.look_up(opened, name, trail));
                    }
                }
            }
        }
        trail.remove(&step);
        targets
    }
}

/// Returns groups of files that all use each other, directly or indirectly.
pub fn circles(uses: &Uses) -> Vec<BTreeSet<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        uses.keys().map(|file| (file, reached_from(uses, file))).collect();
    let mut circles: Vec<BTreeSet<String>> = Vec::new();
    for (file, others) in &reached {
        let circle: BTreeSet<String> = others
            .iter()
            .filter(|other| reached.get(*other).is_some_and(|back| back.contains(file)))
            .map(|other| (*other).clone())
            .collect();
        if !circle.is_empty() && !circles.contains(&circle) {
            circles.push(circle);
        }
    }
    circles
}

fn reached_from<'a>(uses: &'a Uses, file: &'a String) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![file];
    while let Some(file) = open.pop() {
        let used = uses.get(file).into_iter().flat_map(BTreeMap::keys);
        open.extend(used.filter(|used| reached.insert(*used)));
    }
    reached
}

/// Describes a circle: its files with the names that they use, one line per pair.
pub fn describe(circle: &BTreeSet<String>, uses: &Uses) -> String {
    let mut lines = Vec::new();
    for user in circle {
        for (used, names) in uses.get(user).into_iter().flatten().filter(|(used, _)| circle.contains(*used)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            lines.push(format!("  {user} uses {} of {used}", names.join(", ")));
        }
    }
    lines.join("\n")
}

/// Reduces the uses to those between the modules that a crate's root declares: all files of a module are merged under its
/// path without `.rs`.
pub fn between_top_modules(uses: &Uses, root: &str) -> Uses {
    let folder = root.rsplit_once('/').map_or("", |(folder, _)| folder);
    let module = |file: &str| -> String {
        let below = file[folder.len()..].trim_start_matches('/');
        let name = below.split('/').next().unwrap_or(below).trim_end_matches(".rs");
        if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
    };
    let mut merged = Uses::new();
    for (user, others) in uses {
        for (used, names) in others {
            let (user, used) = (module(user), module(used));
            if user != used {
                merged.entry(user).or_default().entry(used).or_default().extend(names.iter().cloned());
            }
        }
    }
    merged
}
