//! The leaves of `use` items.

use super::tree::{ALL, Namespace, TYPES};
use syn::{Ident, ItemUse, UseTree, Visibility};

/// One leaf of a `use` item: `a::b` and `a::c` in `use a::{b, c}`.
#[derive(Clone)]
pub struct Import {
    /// The path as it is written, without a `self` at its end.
    pub path: Vec<String>,
    /// The name that it gets here; none if it is a glob or gets `_`.
    pub name: Option<String>,
    /// Whether it ends with `*`.
    pub glob: bool,
    /// Whether it ends with `self`, which brings a module or a type and nothing else of its name.
    pub only_type: bool,
    /// Whether it begins with `::`.
    pub external: bool,
    /// Whether it is `pub`, of whatever kind.
    pub reexport: bool,
    /// The line that it is written in.
    pub line: usize,
}

impl Import {
    /// Where its path's last name is looked for.
    pub fn namespaces(&self) -> &'static [Namespace] {
        if self.only_type || self.glob { TYPES } else { ALL }
    }
}

/// All leaves of a `use` item.
pub fn leaves(item: &ItemUse) -> Vec<Import> {
    let stem = Import {
        path: Vec::new(),
        name: None,
        glob: false,
        only_type: false,
        external: item.leading_colon.is_some(),
        reexport: !matches!(item.vis, Visibility::Inherited),
        line: 0,
    };
    let mut leaves = Vec::new();
    grow(&item.tree, &stem, &mut leaves);
    leaves
}

fn grow(tree: &UseTree, stem: &Import, leaves: &mut Vec<Import>) {
    match tree {
        UseTree::Path(tree) => {
            let mut stem = stem.clone();
            stem.path.push(tree.ident.to_string());
            grow(&tree.tree, &stem, leaves);
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| grow(tree, stem, leaves)),
        UseTree::Name(tree) => leaves.push(leaf(stem, &tree.ident, None)),
        UseTree::Rename(tree) => leaves.push(leaf(stem, &tree.ident, Some(&tree.rename))),
        UseTree::Glob(tree) => leaves.push(Import {
            glob: true,
            line: tree.star_token.spans[0].start().line,
            ..stem.clone()
        }),
    }
}

fn leaf(stem: &Import, ident: &Ident, rename: Option<&Ident>) -> Import {
    let mut path = stem.path.clone();
    let only_type = ident == "self" && !path.is_empty();
    if !only_type {
        path.push(ident.to_string());
    }
    let name = rename.map_or_else(|| path.last().cloned(), |rename| Some(rename.to_string()));
    Import {
        path,
        name: name.filter(|name| name != "_"),
        only_type,
        line: ident.span().start().line,
        ..stem.clone()
    }
}
