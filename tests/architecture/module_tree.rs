//! Module tree of a crate: what each module defines, imports and mentions, read from the sources.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    Attribute, Item, ItemMod, ItemUse, Macro, Meta, PatIdent, Path, UseTree, Visibility,
    visit::{self, Visit},
};

/// Sources of a crate: text of each file by its path.
pub type Sources = BTreeMap<String, String>;

/// Index of a module in its tree; the crate's root is 0.
pub type ModuleId = usize;

/// Module: a file, or a `mod name { … }` inside one.
#[derive(Debug, Default)]
pub struct Module {
    pub file: String,
    pub parent: Option<ModuleId>,
    pub children: BTreeMap<String, ModuleId>,
    /// Names of the items that are defined in the module.
    pub items: BTreeSet<String>,
    pub imports: Vec<Import>,
    /// Paths in the code of the module, apart from `use` declarations.
    pub mentions: BTreeSet<Vec<String>>,
}

/// Name imported by a `use` declaration.
#[derive(Debug)]
pub struct Import {
    /// Name in this module; `*` for all names of another module.
    pub name: String,
    pub path: Vec<String>,
    pub is_reexport: bool,
}

/// All modules of a crate except those for tests.
#[derive(Debug)]
pub struct ModuleTree {
    pub modules: Vec<Module>,
}

impl ModuleTree {
    /// Reads a crate from its root file along the `mod` declarations.
    pub fn read(sources: &Sources, root: &str) -> Self {
        let mut tree = Self { modules: Vec::new() };
        tree.add_file(sources, root, None);
        tree
    }

    fn add_file(&mut self, sources: &Sources, file: &str, parent: Option<ModuleId>) -> ModuleId {
        let syntax = syn::parse_file(&sources[file]).unwrap_or_else(|error| panic!("{file}: {error}"));
        // Submodules of `lib.rs`, `main.rs` and `mod.rs` are beside the file, those of `name.rs` in `name/`.
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let stem = name.trim_end_matches(".rs");
        let is_beside = parent.is_none() || stem == "mod";
        let folder = if is_beside { folder.to_owned() } else { inside(folder, stem) };
        self.add_module(sources, file, &folder, parent, &syntax.items)
    }

    fn add_module(
        &mut self,
        sources: &Sources,
        file: &str,
        folder: &str,
        parent: Option<ModuleId>,
        items: &[Item],
    ) -> ModuleId {
        let id = self.modules.len();
        self.modules.push(Module { file: file.to_owned(), parent, ..Module::default() });
        let mut reader = Reader::default();
        for item in items.iter().filter(|item| !attributes(item).iter().any(is_for_tests)) {
            if let Item::Mod(module) = item {
                let name = module.ident.to_string();
                let child = self.add_child(sources, file, &inside(folder, &name), id, module);
                self.modules[id].children.insert(name, child);
            } else {
                self.modules[id].items.extend(defined_name(item));
                reader.visit_item(item);
            }
        }
        let bound = &reader.bound;
        reader.mentions.retain(|path| !(path.len() == 1 && bound.contains(&path[0])));
        self.modules[id].imports = reader.imports;
        self.modules[id].mentions = reader.mentions;
        id
    }

    /// Adds a submodule; `place` is the path of its file without `.rs`.
    fn add_child(
        &mut self,
        sources: &Sources,
        file: &str,
        place: &str,
        parent: ModuleId,
        module: &ItemMod,
    ) -> ModuleId {
        if let Some((_, items)) = &module.content {
            return self.add_module(sources, file, place, Some(parent), items);
        }
        let candidates = [format!("{place}.rs"), format!("{place}/mod.rs")];
        let found = candidates.iter().find(|candidate| sources.contains_key(*candidate));
        let found = found.unwrap_or_else(|| panic!("{file}: no file for the module {}", module.ident));
        self.add_file(sources, found, Some(parent))
    }
}

fn inside(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

/// Visitor that collects what a module's code mentions.
#[derive(Default)]
struct Reader {
    imports: Vec<Import>,
    mentions: BTreeSet<Vec<String>>,
    /// Names of local variables and parameters: on their own they do not refer to items.
    bound: BTreeSet<String>,
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        if !attributes(item).iter().any(is_for_tests) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !function.attrs.iter().any(is_for_tests) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let is_reexport = !matches!(item.vis, Visibility::Inherited);
        collect_imports(&item.tree, &mut Vec::new(), is_reexport, &mut self.imports);
    }

    fn visit_path(&mut self, path: &'ast Path) {
        if path.leading_colon.is_none() {
            self.mentions.insert(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_pat_ident(&mut self, pattern: &'ast PatIdent) {
        self.bound.insert(pattern.ident.to_string());
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.visit_path(&call.path);
        collect_paths(call.tokens.clone(), &mut self.mentions);
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

/// Collects paths from the tokens of a macro call, which are not parsed as a syntax tree.
fn collect_paths(tokens: TokenStream, paths: &mut BTreeSet<Vec<String>>) {
    let mut path: Vec<String> = Vec::new();
    let mut colons = 0;
    for token in tokens {
        match token {
            TokenTree::Ident(name) if !path.is_empty() && colons == 2 => path.push(name.to_string()),
            TokenTree::Ident(name) => {
                paths.insert(std::mem::replace(&mut path, vec![name.to_string()]));
            }
            TokenTree::Punct(mark) if mark.as_char() == ':' && !path.is_empty() && colons < 2 => {
                colons += 1;
                continue;
            }
            other => {
                paths.insert(std::mem::take(&mut path));
                if let TokenTree::Group(group) = other {
                    collect_paths(group.stream(), paths);
                }
            }
        }
        colons = 0;
    }
    paths.insert(path);
    paths.remove(&Vec::new());
}

fn collect_imports(tree: &UseTree, prefix: &mut Vec<String>, is_reexport: bool, imports: &mut Vec<Import>) {
    let mut add = |name: String, last: Option<String>| {
        // `use a::{self}` imports `a`.
        let last = last.filter(|last| last != "self" || prefix.is_empty());
        let name = if name == "self" { prefix.last().cloned().unwrap_or(name) } else { name };
        imports.push(Import { name, path: prefix.iter().cloned().chain(last).collect(), is_reexport });
    };
    match tree {
        UseTree::Name(name) => add(name.ident.to_string(), Some(name.ident.to_string())),
        UseTree::Rename(rename) => add(rename.rename.to_string(), Some(rename.ident.to_string())),
        UseTree::Glob(_) => add("*".to_owned(), None),
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            collect_imports(&path.tree, prefix, is_reexport, imports);
            prefix.pop();
        }
        UseTree::Group(group) => {
            for tree in &group.items {
                collect_imports(tree, prefix, is_reexport, imports);
            }
        }
    }
}

/// Whether something is compiled only for tests.
fn is_for_tests(attribute: &Attribute) -> bool {
    let Meta::List(list) = &attribute.meta else { return false };
    let names: Vec<String> = list.tokens.clone().into_iter().map(|token| token.to_string()).collect();
    list.path.is_ident("cfg") && names == ["test"]
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn defined_name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}
