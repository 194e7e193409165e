//! The graph of a crate's files: which file uses what of which other.

use super::leaves::{Import, leaves};
use super::tree::{
    ALL, MACROS, ModuleId, Namespace, Read, TYPES, TYPES_AND_VALUES, Target, Tree, VALUES, attributes, is_for_tests,
};
use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, HashSet};
use syn::parse::Parser;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{ImplItem, Item, Meta, Stmt, Token};

/// The place where a file first uses an item of another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Use {
    /// The path as it is written.
    pub path: String,
    pub line: usize,
}

/// The files of a crate and what they use of each other.
#[derive(Debug)]
pub struct Graph {
    /// Paths relative to the folder of sources.
    pub files: Vec<String>,
    /// What the first file of a pair uses of the second, one place for each item. Files are numbers in
    /// [`files`](Self::files).
    pub uses: BTreeMap<(usize, usize), Vec<Use>>,
    /// What could not be read or followed, as `file:line: why`.
    pub errors: Vec<String>,
}

impl Graph {
    /// Reads the crate whose root is `lib.rs`. If `strict`, imports of modules and all re-exports are uses as well.
    pub fn read(read: Read, strict: bool) -> Self {
        let mut walk = Walk {
            tree: Tree::read(read),
            strict,
            module: 0,
            variables: HashSet::new(),
            noted: HashSet::new(),
            uses: BTreeMap::new(),
        };
        while let Some((module, items)) = walk.tree.items.pop() {
            walk.module = module;
            items.iter().for_each(|item| walk.visit_item(item));
        }
        Self {
            files: walk.tree.files,
            uses: walk.uses,
            errors: walk.tree.errors,
        }
    }

    /// The pairs of files the first of which uses the second.
    pub fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        self.uses.keys().copied()
    }
}

/// A walk over all items of all modules.
struct Walk {
    tree: Tree,
    strict: bool,
    /// The module or block that the walk is in.
    module: ModuleId,
    /// The names of variables in the function that the walk is in: they hide items.
    variables: HashSet<String>,
    noted: HashSet<(usize, Target)>,
    uses: BTreeMap<(usize, usize), Vec<Use>>,
}

impl Walk {
    fn file(&self) -> usize {
        self.tree.modules[self.module].file
    }

    fn note(&mut self, target: &Target, path: &[String], line: usize) {
        let Some(module) = target.module() else {
            return;
        };
        let (from, to) = (self.file(), self.tree.modules[module].file);
        if from != to && self.noted.insert((from, target.clone())) {
            let path = path.join("::");
            self.uses.entry((from, to)).or_default().push(Use { path, line });
        }
    }

    /// Reports a path of this crate that cannot be followed: its use would be missed.
    fn check(&mut self, found: &[Target], path: &[String], line: usize) {
        if found.is_empty() && !self.tree.begins_outside(self.module, path) {
            let file = &self.tree.files[self.file()];
            let path = path.join("::");
            self.tree.errors.push(format!("{file}:{line}: cannot follow `{path}`"));
        }
    }

    fn import(&mut self, import: &Import) {
        if import.external {
            return;
        }
        let found = self.tree.resolve(self.module, &import.path, import.namespaces());
        self.check(&found, &import.path, import.line);
        for target in &found {
            let counts = match target {
                // What counts are the paths that begin with the module's name. A glob has no name.
                Target::Module(_) => import.glob && !import.reexport,
                // A file may re-export what is below it.
                Target::Item(home, _) => !import.reexport || !self.tree.is_below_file_of(*home, self.module),
                Target::External => false,
            };
            if counts || self.strict {
                self.note(target, &import.path, import.line);
            }
        }
    }

    /// Notes what a path in code uses.
    fn path(&mut self, path: &[String], namespaces: &[Namespace], line: usize) -> Vec<Target> {
        let found = self.tree.resolve(self.module, path, namespaces);
        for target in &found {
            if matches!(target, Target::Item(..)) {
                self.note(target, path, line);
            }
        }
        found
    }

    /// Notes what the first `count` names of a path use.
    fn names(&mut self, path: &syn::Path, count: usize, namespaces: &[Namespace]) {
        if path.leading_colon.is_none() && count > 0 {
            let names: Vec<String> = path.segments.iter().take(count).map(|s| s.ident.to_string()).collect();
            let line = path.segments[0].ident.span().start().line;
            let found = self.path(&names, namespaces, line);
            if count > 1 {
                self.check(&found, &names, line);
            }
        }
    }

    /// Notes what a path and its parameters use. In `<T as Trait>::Item` what is used is `T` and `Trait`.
    fn qualified(&mut self, of: Option<&syn::QSelf>, path: &syn::Path, namespaces: &[Namespace]) {
        if let Some(of) = of {
            self.visit_type(&of.ty);
            self.names(path, of.position, TYPES);
        } else {
            self.names(path, path.segments.len(), namespaces);
        }
        path.segments
            .iter()
            .for_each(|segment| self.visit_path_segment(segment));
    }

    /// Notes what is used in tokens that only their macro understands: paths of several names, and single names that
    /// begin with a capital letter.
    fn tokens(&mut self, tokens: &TokenStream) {
        let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
        let is = |i: Option<usize>, c| {
            let token = i.and_then(|i| tokens.get(i));
            matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == c)
        };
        let mut i = 0;
        while i < tokens.len() {
            if let TokenTree::Group(group) = &tokens[i] {
                self.tokens(&group.stream());
            } else if let TokenTree::Ident(first) = &tokens[i] {
                let (before, second) = (i.checked_sub(1), i.checked_sub(2));
                let mut names = vec![first.to_string()];
                while is(Some(i + 1), ':')
                    && is(Some(i + 2), ':')
                    && let Some(TokenTree::Ident(name)) = tokens.get(i + 3)
                {
                    names.push(name.to_string());
                    i += 3;
                }
                let is_field = is(before, '.') && !is(second, '.');
                let is_lifetime = is(before, '\'');
                let is_rest = is(before, ':') && is(second, ':');
                let is_parameter = is(before, '$') && names[0] != "crate";
                let may_be_item = names.len() > 1 || names[0].starts_with(char::is_uppercase);
                if may_be_item && !is_field && !is_lifetime && !is_rest && !is_parameter {
                    let line = first.span().start().line;
                    let found = self.path(&names, ALL, line);
                    if names[0] == "crate" {
                        self.check(&found, &names, line);
                    }
                }
            }
            i += 1;
        }
    }

    /// Visits a function, in which its variables hide items.
    fn function(&mut self, signature: &syn::Signature, body: Option<&syn::Block>, visit: impl FnOnce(&mut Self)) {
        let mut variables = Variables(self.variables.clone());
        variables.visit_signature(signature);
        if let Some(body) = body {
            variables.visit_block(body);
        }
        let outer = std::mem::replace(&mut self.variables, variables.0);
        visit(self);
        self.variables = outer;
    }
}

/// The names of variables that patterns bind. Names with a capital letter are constants.
struct Variables(HashSet<String>);

impl<'a> Visit<'a> for Variables {
    fn visit_pat_ident(&mut self, pattern: &'a syn::PatIdent) {
        let name = pattern.ident.to_string();
        if !name.starts_with(char::is_uppercase) {
            self.0.insert(name);
        }
        visit::visit_pat_ident(self, pattern);
    }
}

/// Visits what is not only there for tests.
macro_rules! unless_for_tests {
    ($($method:ident($type:ident);)*) => {
        $(fn $method(&mut self, node: &'a syn::$type) {
            if !is_for_tests(&node.attrs) {
                visit::$method(self, node);
            }
        })*
    };
}

impl<'a> Visit<'a> for Walk {
    unless_for_tests! {
        visit_arm(Arm);
        visit_field(Field);
        visit_field_value(FieldValue);
        visit_local(Local);
        visit_variant(Variant);
    }

    fn visit_item(&mut self, item: &'a Item) {
        if !is_for_tests(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'a ImplItem) {
        let attributes: &[_] = match item {
            ImplItem::Const(item) => &item.attrs,
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            ImplItem::Macro(item) => &item.attrs,
            _ => &[],
        };
        if !is_for_tests(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    /// A module's items are visited on their own, and its declaration uses nothing.
    fn visit_item_mod(&mut self, _: &'a syn::ItemMod) {}

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        leaves(item).iter().for_each(|import| self.import(import));
    }

    fn visit_item_fn(&mut self, item: &'a syn::ItemFn) {
        self.function(&item.sig, Some(&item.block), |walk| visit::visit_item_fn(walk, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'a syn::ImplItemFn) {
        self.function(&item.sig, Some(&item.block), |walk| {
            visit::visit_impl_item_fn(walk, item)
        });
    }

    fn visit_trait_item_fn(&mut self, item: &'a syn::TraitItemFn) {
        self.function(&item.sig, item.default.as_ref(), |walk| {
            visit::visit_trait_item_fn(walk, item)
        });
    }

    fn visit_block(&mut self, block: &'a syn::Block) {
        let item = |statement: &Stmt| match statement {
            Stmt::Item(item) => Some(item.clone()),
            _ => None,
        };
        let items: Vec<Item> = block.stmts.iter().filter_map(item).collect();
        let outer = self.module;
        if !items.is_empty() {
            self.module = self.tree.push_block(outer, &items);
        }
        visit::visit_block(self, block);
        self.module = outer;
    }

    fn visit_expr_path(&mut self, expression: &'a syn::ExprPath) {
        match expression.path.get_ident() {
            Some(name) if self.variables.contains(&name.to_string()) => {}
            Some(_) => self.names(&expression.path, 1, VALUES),
            None => self.qualified(expression.qself.as_ref(), &expression.path, ALL),
        }
    }

    fn visit_type_path(&mut self, path: &'a syn::TypePath) {
        self.qualified(path.qself.as_ref(), &path.path, TYPES);
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        self.qualified(None, path, TYPES_AND_VALUES);
    }

    fn visit_pat_ident(&mut self, pattern: &'a syn::PatIdent) {
        let name = pattern.ident.to_string();
        if name.starts_with(char::is_uppercase) {
            self.path(&[name], VALUES, pattern.ident.span().start().line);
        }
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_attribute(&mut self, attribute: &'a syn::Attribute) {
        let ignored = ["doc", "cfg", "allow", "expect", "warn", "deny", "repr", "inline"];
        if let Meta::List(list) = &attribute.meta
            && !ignored.iter().any(|name| list.path.is_ident(name))
        {
            self.tokens(&list.tokens);
        }
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        if call.path.is_ident("macro_rules") {
            return self.tokens(&call.tokens);
        }
        self.names(&call.path, call.path.segments.len(), MACROS);
        let expressions = Punctuated::<syn::Expr, Token![,]>::parse_terminated;
        match expressions.parse2(call.tokens.clone()) {
            Ok(expressions) => expressions.iter().for_each(|expression| self.visit_expr(expression)),
            Err(_) => self.tokens(&call.tokens),
        }
    }
}
