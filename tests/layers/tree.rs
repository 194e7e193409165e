//! The modules of a crate, the names in each, and what a path leads to.

use super::leaves::{Import, leaves};
use proc_macro2::{TokenStream, TokenTree};
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use syn::punctuated::Punctuated;
use syn::{Attribute, Item, Meta, Token};

/// Reads a source file, by its path relative to the folder of sources.
pub type Read<'r> = &'r dyn Fn(&str) -> Option<String>;

/// A module by its number in [`Tree::modules`].
pub type ModuleId = usize;

/// The crate's root.
const ROOT: ModuleId = 0;

/// A module, or a block with items of its own, which is a module without a name.
#[derive(Default)]
pub struct Module {
    /// The file it is written in, by its number in [`Tree::files`].
    pub file: usize,
    parent: Option<ModuleId>,
    /// Whether it is a block: names that it lacks are looked up around it.
    block: bool,
    names: HashMap<String, Vec<Binding>>,
    globs: Vec<Import>,
    /// The macros that are called as items, and all identifiers in these calls.
    called: HashSet<String>,
    in_calls: HashSet<String>,
}

/// What defines a name in a module.
enum Binding {
    Module(ModuleId),
    /// An item, the module that it stands in, and the variants of an enum.
    Item(Namespace, ModuleId, Vec<String>),
    Import(Import),
}

/// The namespaces of Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Namespace {
    Types,
    Values,
    Macros,
}

pub const TYPES: &[Namespace] = &[Namespace::Types];
pub const VALUES: &[Namespace] = &[Namespace::Values];
pub const TYPES_AND_VALUES: &[Namespace] = &[Namespace::Types, Namespace::Values];
pub const MACROS: &[Namespace] = &[Namespace::Macros];
pub const ALL: &[Namespace] = &[Namespace::Types, Namespace::Values, Namespace::Macros];

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    Module(ModuleId),
    /// An item, by the module that defines it and its name there.
    Item(ModuleId, String),
    /// Something of another crate.
    External,
}

impl Target {
    /// The module that is meant, or that defines the item.
    pub fn module(&self) -> Option<ModuleId> {
        match self {
            Self::Module(module) | Self::Item(module, _) => Some(*module),
            Self::External => None,
        }
    }
}

/// A name that is being looked up or has been.
type Name = (ModuleId, String, Namespace);

/// The modules of a crate.
#[derive(Default)]
pub struct Tree {
    /// Paths relative to the folder of sources.
    pub files: Vec<String>,
    pub modules: Vec<Module>,
    /// The items of each module that is not a block, until someone takes them.
    pub items: Vec<(ModuleId, Vec<Item>)>,
    /// What could not be read, as `file:line: why`.
    pub errors: Vec<String>,
    /// All identifiers in the body of a `macro_rules!`, by its name.
    macros: HashMap<String, HashSet<String>>,
    known: RefCell<HashMap<Name, Vec<Target>>>,
}

impl Tree {
    /// Reads the crate whose root is `lib.rs`.
    pub fn read(read: Read) -> Self {
        let mut tree = Self::default();
        tree.read_file("lib.rs".into(), None, "", read);
        tree
    }

    /// Reads a file and those of its modules, which are in `folder`.
    fn read_file(&mut self, path: String, parent: Option<ModuleId>, folder: &str, read: Read) -> Option<ModuleId> {
        let file = match read(&path).map(|text| syn::parse_file(&text)) {
            Some(Ok(file)) => file,
            Some(Err(error)) => {
                let line = error.span().start().line;
                self.errors.push(format!("{path}:{line}: {error}"));
                return None;
            }
            None => {
                self.errors.push(format!("{path}: this file is missing"));
                return None;
            }
        };
        if is_for_tests(&file.attrs) {
            return None;
        }
        self.files.push(path);
        let module = self.push(self.files.len() - 1, parent, false);
        self.collect(module, &file.items, Some((folder, read)));
        self.items.push((module, file.items));
        Some(module)
    }

    fn push(&mut self, file: usize, parent: Option<ModuleId>, block: bool) -> ModuleId {
        self.modules.push(Module {
            file,
            parent,
            block,
            ..Module::default()
        });
        self.modules.len() - 1
    }

    /// Makes a scope of the items in a block.
    pub fn push_block(&mut self, parent: ModuleId, items: &[Item]) -> ModuleId {
        let block = self.push(self.modules[parent].file, Some(parent), true);
        self.collect(block, items, None);
        block
    }

    /// Notes the names that `items` define. Files of modules are in a folder; blocks have none.
    fn collect(&mut self, module: ModuleId, items: &[Item], files: Option<(&str, Read)>) {
        use Namespace::{Macros, Types, Values};
        for item in items.iter().filter(|item| !is_for_tests(attributes(item))) {
            match item {
                Item::Mod(child) => self.collect_module(module, child, files),
                Item::Use(item) => {
                    for import in leaves(item) {
                        match &import.name {
                            _ if import.glob => self.modules[module].globs.push(import),
                            Some(name) => self.bind(module, name.clone(), Binding::Import(import)),
                            None => {}
                        }
                    }
                }
                Item::Const(item) => self.define(module, &item.ident, &[Values]),
                Item::Static(item) => self.define(module, &item.ident, &[Values]),
                Item::Fn(item) => self.define(module, &item.sig.ident, &[Values]),
                Item::Struct(item) => self.define(module, &item.ident, &[Types, Values]),
                Item::Union(item) => self.define(module, &item.ident, &[Types]),
                Item::Type(item) => self.define(module, &item.ident, &[Types]),
                Item::Trait(item) => self.define(module, &item.ident, &[Types]),
                Item::Enum(item) => {
                    let variants = item.variants.iter().map(|v| v.ident.to_string()).collect();
                    self.bind(module, item.ident.to_string(), Binding::Item(Types, module, variants));
                }
                Item::Macro(item) => {
                    if let Some(name) = &item.ident {
                        identifiers(&item.mac.tokens, self.macros.entry(name.to_string()).or_default());
                        self.define(module, name, &[Macros]);
                        if module != ROOT && has(&item.attrs, "macro_export") {
                            self.bind(ROOT, name.to_string(), Binding::Item(Macros, module, Vec::new()));
                        }
                    } else if let Some(last) = item.mac.path.segments.last() {
                        self.modules[module].called.insert(last.ident.to_string());
                        identifiers(&item.mac.tokens, &mut self.modules[module].in_calls);
                    }
                }
                _ => {}
            }
        }
    }

    fn collect_module(&mut self, parent: ModuleId, item: &syn::ItemMod, files: Option<(&str, Read)>) {
        let name = item.ident.to_string();
        let below = files.map(|(folder, read)| (format!("{folder}{name}/"), read));
        let child = if let Some((_, items)) = &item.content {
            let child = self.push(self.modules[parent].file, Some(parent), false);
            self.collect(
                child,
                items,
                below.as_ref().map(|(folder, read)| (folder.as_str(), *read)),
            );
            self.items.push((child, items.clone()));
            Some(child)
        } else if let Some((below, read)) = below
            && !has(&item.attrs, "path")
        {
            let beside = format!("{}.rs", &below[..below.len() - 1]);
            let path = if read(&beside).is_some() {
                beside
            } else {
                format!("{below}mod.rs")
            };
            self.read_file(path, Some(parent), &below, read)
        } else {
            let file = &self.files[self.modules[parent].file];
            let line = item.ident.span().start().line;
            self.errors.push(format!(
                "{file}:{line}: modules with `#[path]` or in blocks are not understood"
            ));
            None
        };
        if let Some(child) = child {
            self.bind(parent, name, Binding::Module(child));
        }
    }

    fn define(&mut self, module: ModuleId, name: &syn::Ident, namespaces: &[Namespace]) {
        for &namespace in namespaces {
            self.bind(module, name.to_string(), Binding::Item(namespace, module, Vec::new()));
        }
    }

    fn bind(&mut self, module: ModuleId, name: String, binding: Binding) {
        self.modules[module].names.entry(name).or_default().push(binding);
    }

    /// A module and all around it, from the inside out.
    fn around(&self, module: ModuleId) -> impl Iterator<Item = ModuleId> {
        std::iter::successors(Some(module), |&m| self.modules[m].parent)
    }

    /// The module that a block is in, or the module itself.
    fn without_blocks(&self, module: ModuleId) -> ModuleId {
        self.around(module)
            .find(|&m| !self.modules[m].block)
            .expect("the root is no block")
    }

    /// Whether `module` is in the file of `other`, or in a module below that.
    pub fn is_below_file_of(&self, module: ModuleId, other: ModuleId) -> bool {
        let file = self.modules[other].file;
        self.around(module).any(|m| self.modules[m].file == file)
    }

    /// What a path leads to that is written in `module`; nothing if the crate has no such name.
    pub fn resolve(&self, module: ModuleId, path: &[String], namespaces: &[Namespace]) -> Vec<Target> {
        let mut found = Vec::new();
        for &namespace in namespaces {
            for target in self.follow(module, path, namespace, &mut Vec::new()) {
                if !found.contains(&target) {
                    found.push(target);
                }
            }
        }
        found
    }

    /// Whether a path's first name is nothing of this crate, but of another, or a parameter's or Rust's own.
    pub fn begins_outside(&self, module: ModuleId, path: &[String]) -> bool {
        self.is_outside(module, path, &mut Vec::new())
    }

    fn is_outside(&self, module: ModuleId, path: &[String], seen: &mut Vec<Name>) -> bool {
        let mut is_external = |&namespace: &Namespace| {
            let found = self.in_scope(module, &path[0], namespace, seen);
            found.iter().all(|target| *target == Target::External)
        };
        !matches!(path[0].as_str(), "crate" | "self" | "super") && ALL.iter().all(&mut is_external)
    }

    fn follow(&self, module: ModuleId, path: &[String], last: Namespace, seen: &mut Vec<Name>) -> Vec<Target> {
        let mut start = self.without_blocks(module);
        let mut names = path;
        while let Some((first, rest)) = names.split_first() {
            match (first.as_str(), self.modules[start].parent) {
                ("crate", _) => start = ROOT,
                ("self", _) => {}
                ("super", Some(parent)) => start = self.without_blocks(parent),
                ("super", None) => return Vec::new(),
                _ => break,
            }
            names = rest;
        }
        let mut found = vec![Target::Module(start)];
        for (i, name) in names.iter().enumerate() {
            let namespace = if i + 1 == names.len() { last } else { Namespace::Types };
            let next = |target| match target {
                Target::Module(_) if i == 0 && names.len() == path.len() => {
                    self.in_scope(module, name, namespace, seen)
                }
                Target::Module(inner) => self.lookup(inner, name, namespace, seen),
                // The rest of the path is in the item: a variant, or something associated.
                item => vec![item],
            };
            found = found.into_iter().flat_map(next).collect();
        }
        found
    }

    /// What a name in `module` stands for, or else in the module around a block.
    fn in_scope(&self, module: ModuleId, name: &str, namespace: Namespace, seen: &mut Vec<Name>) -> Vec<Target> {
        for scope in self.around(module) {
            let found = self.lookup(scope, name, namespace, seen);
            // Macros are known in all modules below theirs.
            if !found.is_empty() || !self.modules[scope].block && namespace != Namespace::Macros {
                return found;
            }
        }
        Vec::new()
    }

    /// What a name in a module stands for.
    fn lookup(&self, module: ModuleId, name: &str, namespace: Namespace, seen: &mut Vec<Name>) -> Vec<Target> {
        let key = (module, name.to_owned(), namespace);
        if let Some(known) = self.known.borrow().get(&key) {
            return known.clone();
        }
        // Imports may lead back to themselves.
        if seen.contains(&key) {
            return Vec::new();
        }
        seen.push(key);
        let mut found = self.lookup_named(module, name, namespace, seen);
        if found.is_empty() {
            for glob in &self.modules[module].globs {
                found.extend(self.lookup_in_glob(module, glob, name, namespace, seen));
            }
        }
        // Any name may come from another crate's glob, and then says nothing.
        let is_known =
            found.iter().any(|target| *target != Target::External) || self.modules[module].names.contains_key(name);
        if !is_known && self.may_generate(module, name) {
            found.push(Target::Item(module, name.to_owned()));
        }
        // What is found within a cycle of imports may be incomplete.
        if let Some(key) = seen.pop()
            && seen.is_empty()
        {
            self.known.borrow_mut().insert(key, found.clone());
        }
        found
    }

    fn lookup_named(&self, module: ModuleId, name: &str, namespace: Namespace, seen: &mut Vec<Name>) -> Vec<Target> {
        let mut found = Vec::new();
        for binding in self.modules[module].names.get(name).into_iter().flatten() {
            match binding {
                Binding::Module(child) if namespace == Namespace::Types => found.push(Target::Module(*child)),
                Binding::Item(of, home, _) if *of == namespace => found.push(Target::Item(*home, name.to_owned())),
                Binding::Import(import) if import.external => found.push(Target::External),
                Binding::Import(import) if !import.only_type || namespace == Namespace::Types => {
                    let targets = self.follow(module, &import.path, namespace, seen);
                    if targets.is_empty() && self.is_outside(module, &import.path, seen) {
                        found.push(Target::External);
                    }
                    found.extend(targets);
                }
                _ => {}
            }
        }
        found
    }

    fn lookup_in_glob(
        &self,
        module: ModuleId,
        glob: &Import,
        name: &str,
        namespace: Namespace,
        seen: &mut Vec<Name>,
    ) -> Vec<Target> {
        if glob.external || self.is_outside(module, &glob.path, seen) {
            return vec![Target::External];
        }
        let mut found = Vec::new();
        for target in self.follow(module, &glob.path, Namespace::Types, seen) {
            match target {
                Target::Module(inner) => found.extend(self.lookup(inner, name, namespace, seen)),
                Target::Item(home, item) if self.has_variant(home, &item, name) => {
                    found.push(Target::Item(home, item));
                }
                Target::Item(..) => {}
                Target::External => found.push(Target::External),
            }
        }
        found
    }

    fn has_variant(&self, module: ModuleId, item: &str, variant: &str) -> bool {
        let bindings = self.modules[module].names.get(item).into_iter().flatten();
        let mut variants = bindings.filter_map(|binding| match binding {
            Binding::Item(_, _, variants) => Some(variants),
            _ => None,
        });
        variants.any(|variants| variants.iter().any(|v| v == variant))
    }

    /// Whether a macro that is called in a module may define a name there: one in the call, or in the macro's body.
    fn may_generate(&self, module: ModuleId, name: &str) -> bool {
        let module = &self.modules[module];
        let bodies = module.called.iter().filter_map(|called| self.macros.get(called));
        module.in_calls.contains(name) || bodies.into_iter().any(|body| body.contains(name))
    }
}

/// Adds all identifiers in `tokens`.
fn identifiers(tokens: &TokenStream, to: &mut HashSet<String>) {
    for token in tokens.clone() {
        match token {
            TokenTree::Ident(ident) => {
                to.insert(ident.to_string());
            }
            TokenTree::Group(group) => identifiers(&group.stream(), to),
            _ => {}
        }
    }
}

fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident(name))
}

/// Whether something is compiled for tests only.
pub fn is_for_tests(attributes: &[Attribute]) -> bool {
    let conditions = attributes.iter().filter(|attribute| attribute.path().is_ident("cfg"));
    conditions
        .filter_map(|attribute| attribute.parse_args().ok())
        .any(|condition| needs_test(&condition))
}

fn needs_test(condition: &Meta) -> bool {
    let Meta::List(list) = condition else {
        return condition.path().is_ident("test") || condition.path().is_ident("doctest");
    };
    let Ok(parts) = list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated) else {
        return false;
    };
    if list.path.is_ident("all") {
        parts.iter().any(needs_test)
    } else {
        list.path.is_ident("any") && parts.iter().all(needs_test)
    }
}

/// The attributes of an item.
pub fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
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
