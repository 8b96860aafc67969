//! Long files and long functions.

use syn::{
    Block, ImplItemFn, ItemFn, Signature, TraitItemFn,
    visit::{self, Visit},
};

/// Largest number of lines of a file.
pub const MAX_FILE_LINES: usize = 500;
/// Largest number of lines of a function, from `fn` to its closing brace.
pub const MAX_FUNCTION_LINES: usize = 60;

/// Lists files and functions that are too long, as pairs of a place and its number of lines. The place of a file is its
/// path, that of a function `path::function`.
pub fn too_long(file: &str, text: &str) -> Vec<(String, usize)> {
    let syntax = syn::parse_file(text).unwrap_or_else(|error| panic!("{file}: {error}"));
    let mut lengths = FunctionLengths::default();
    lengths.visit_file(&syntax);
    let functions = lengths.0.into_iter().filter(|(_, lines)| *lines > MAX_FUNCTION_LINES);
    let functions = functions.map(|(name, lines)| (format!("{file}::{name}"), lines));
    let lines = text.lines().count();
    let whole = (lines > MAX_FILE_LINES).then(|| (file.to_owned(), lines));
    whole.into_iter().chain(functions).collect()
}

/// Names of functions with their numbers of lines.
#[derive(Default)]
struct FunctionLengths(Vec<(String, usize)>);

impl FunctionLengths {
    fn add(&mut self, signature: &Signature, body: &Block) {
        let first = signature.fn_token.span.start().line;
        let last = body.brace_token.span.close().end().line;
        self.0.push((signature.ident.to_string(), last - first + 1));
    }
}

impl<'ast> Visit<'ast> for FunctionLengths {
    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.add(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        if let Some(body) = &function.default {
            self.add(&function.sig, body);
        }
        visit::visit_trait_item_fn(self, function);
    }
}
