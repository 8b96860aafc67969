//! Tests of the rules themselves on invented sources.

use std::collections::BTreeSet;

use crate::{
    circles::{Uses, between_top_modules, circles, uses},
    module_tree::Sources,
    sizes::{MAX_FILE_LINES, MAX_FUNCTION_LINES, too_long},
};

fn uses_of(files: &[(&str, &str)]) -> Uses {
    let sources: Sources =
        files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect();
    uses(&sources, "lib.rs")
}

fn circles_of(files: &[(&str, &str)]) -> Vec<BTreeSet<String>> {
    circles(&uses_of(files))
}

fn circle(files: &[&str]) -> BTreeSet<String> {
    files.iter().map(|file| (*file).to_owned()).collect()
}

#[test]
fn a_circle_through_a_reexport_is_found() {
    let files = [
        ("lib.rs", "mod filter; mod refine;"),
        (
            "filter/mod.rs",
            "mod motion; mod particles; pub use self::motion::Noise; pub use particles::Filter;",
        ),
        ("filter/motion.rs", "pub struct Noise;"),
        ("filter/particles.rs", "use crate::refine::Fit; pub struct Filter(Fit);"),
        ("refine.rs", "use crate::filter::Filter; pub struct Fit; fn smooth(filter: &Filter) {}"),
    ];
    assert_eq!(circles_of(&files), [circle(&["filter/particles.rs", "refine.rs"])]);
}

#[test]
fn a_child_that_uses_its_parent_which_uses_the_child_is_a_circle() {
    let files = [
        ("lib.rs", "mod panel;"),
        ("panel/mod.rs", "mod view; pub struct Settings; fn ui() { view::draw(&Settings) }"),
        ("panel/view.rs", "use super::Settings; pub fn draw(settings: &Settings) {}"),
    ];
    assert_eq!(circles_of(&files), [circle(&["panel/mod.rs", "panel/view.rs"])]);
    let uses = uses_of(&files);
    assert_eq!(uses["panel/mod.rs"]["panel/view.rs"], BTreeSet::from(["draw".to_owned()]));
    assert_eq!(uses["panel/view.rs"]["panel/mod.rs"], BTreeSet::from(["Settings".to_owned()]));
}

#[test]
fn a_parent_that_only_declares_and_reexports_its_children_uses_none_of_them() {
    let files = [
        ("lib.rs", "mod panel; pub use panel::{Panel, view::*};"),
        (
            "panel.rs",
            "pub mod view; pub mod settings; pub(crate) use self::settings::Settings; pub struct Panel;",
        ),
        ("panel/view.rs", "use super::{Panel, Settings}; pub fn draw(panel: &Panel, settings: &Settings) {}"),
        ("panel/settings.rs", "#[derive(Default)] pub struct Settings;"),
    ];
    assert_eq!(circles_of(&files), [] as [BTreeSet<String>; 0]);
    let uses = uses_of(&files);
    assert_eq!(uses.keys().collect::<Vec<_>>(), ["panel/view.rs"]);
    assert_eq!(uses["panel/view.rs"].keys().collect::<Vec<_>>(), ["panel.rs", "panel/settings.rs"]);
}

#[test]
fn a_parent_that_uses_what_it_reexports_uses_the_child() {
    let files = [
        ("lib.rs", "mod child; pub use child::Child; pub struct Parent(Child);"),
        ("child.rs", "use crate::Parent; pub struct Child; fn of(parent: &Parent) {}"),
    ];
    assert_eq!(circles_of(&files), [circle(&["child.rs", "lib.rs"])]);
}

#[test]
fn folders_that_use_each_other_are_a_circle_of_modules_though_no_files_are() {
    let files = [
        ("lib.rs", "mod filter; mod refine;"),
        ("filter/mod.rs", "mod motion; mod particles;"),
        ("filter/motion.rs", "pub struct Noise;"),
        ("filter/particles.rs", "use crate::refine::Tolerance;"),
        ("refine.rs", "use crate::filter::motion::Noise; pub struct Tolerance;"),
    ];
    assert_eq!(circles_of(&files), [] as [BTreeSet<String>; 0]);
    let modules = between_top_modules(&uses_of(&files), "lib.rs");
    assert_eq!(circles(&modules), [circle(&["filter", "refine"])]);
}

#[test]
fn paths_in_code_and_in_macros_count_like_imports() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "pub fn f() { crate::b::g() }"),
        ("b.rs", "use super::c; pub fn g() { assert!(c::h() > 0, \"{}\", c::h()) }"),
        ("c.rs", "use crate::*; pub fn h() -> u32 { a::f(); 1 }"),
    ];
    assert_eq!(circles_of(&files), [circle(&["a.rs", "b.rs", "c.rs"])]);
}

#[test]
fn globs_lead_to_the_file_that_defines_the_name() {
    let files = [
        ("lib.rs", "mod prelude; mod a; mod b;"),
        ("prelude.rs", "pub use crate::a::*; pub use crate::b::*;"),
        ("a.rs", "use crate::prelude::*; pub struct A(Box<B>);"),
        ("b.rs", "use crate::prelude::*; pub enum B { One(A) }"),
    ];
    assert_eq!(circles_of(&files), [circle(&["a.rs", "b.rs"])]);
}

#[test]
fn a_local_variable_is_not_the_function_of_its_name() {
    let files = [
        ("lib.rs", "mod a; pub use a::rivals; pub struct P; fn f(rivals: u32) -> u32 { rivals }"),
        ("a.rs", "use super::P; pub fn rivals(p: P) {}"),
    ];
    assert_eq!(circles_of(&files), [] as [BTreeSet<String>; 0]);
}

#[test]
fn modules_inside_a_file_belong_to_it_and_modules_for_tests_to_none() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        (
            "a.rs",
            "pub mod inner { use super::super::b::B; pub struct A(B); } #[cfg(test)] mod tests { use crate::b::B; }",
        ),
        (
            "b.rs",
            "pub struct B; #[cfg(test)] mod tests { use crate::a::inner::A; } #[cfg(test)] fn t() { crate::a::inner::A; }",
        ),
    ];
    assert_eq!(uses_of(&files).keys().collect::<Vec<_>>(), ["a.rs"]);
    let back = [files[0], files[1], ("b.rs", "pub struct B; fn f() -> crate::a::inner::A { loop {} }")];
    assert_eq!(circles_of(&back), [circle(&["a.rs", "b.rs"])]);
}

#[test]
fn lengths_are_counted_from_fn_to_the_closing_brace() {
    let function = |lines: usize| format!("/// Text.\nfn f() {{\n{}}}\n", "    g();\n".repeat(lines - 2));
    assert_eq!(too_long("a.rs", &function(MAX_FUNCTION_LINES)), []);
    let long = MAX_FUNCTION_LINES + 1;
    assert_eq!(too_long("a.rs", &function(long)), [("a.rs::f".to_owned(), long)]);
    let method = format!("impl A {{\n{}}}\n", function(long));
    assert_eq!(too_long("a.rs", &method), [("a.rs::f".to_owned(), long)]);
    assert_eq!(too_long("a.rs", &"const A: u8 = 1;\n".repeat(MAX_FILE_LINES)), []);
    let file = "const A: u8 = 1;\n".repeat(MAX_FILE_LINES + 1);
    assert_eq!(too_long("a.rs", &file), [("a.rs".to_owned(), MAX_FILE_LINES + 1)]);
}
