//! The public types of the sources that derive a trait of Bevy's world.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use syn::punctuated::Punctuated;
use syn::{Attribute, Item, Meta, Token, Type, Visibility};

/// A public type, with the last segment of each path in its `derive`.
pub struct Declared {
    pub name: String,
    pub derives: HashSet<String>,
    pub is_enum: bool,
    /// Whether it derives or implements `Default`.
    pub has_default: bool,
}

impl Declared {
    /// Whether it is a component, resource, event or message.
    pub fn is_in_world(&self) -> bool {
        ["Component", "Resource", "Event", "EntityEvent", "Message"]
            .iter()
            .any(|name| self.derives.contains(*name))
    }
}

/// Reads the module in `file`, whose modules are in `folder`, and all that are below it and are compiled.
pub fn read(file: &Path, folder: &Path) -> Vec<Declared> {
    let mut found = DeclaredTypes::default();
    found.read(file, folder);
    for declared in &mut found.types {
        declared.has_default = declared.derives.contains("Default") || found.with_default.contains(&declared.name);
    }
    found.types
}

#[derive(Default)]
struct DeclaredTypes {
    types: Vec<Declared>,
    with_default: HashSet<String>,
}

impl DeclaredTypes {
    fn read(&mut self, file: &Path, folder: &Path) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.collect(&parsed.items, folder);
    }

    fn collect(&mut self, items: &[Item], folder: &Path) {
        for item in items {
            match item {
                Item::Struct(item) if is_compiled(&item.attrs) => {
                    self.declare(&item.vis, &item.ident.to_string(), &item.attrs, false);
                }
                Item::Enum(item) if is_compiled(&item.attrs) => {
                    self.declare(&item.vis, &item.ident.to_string(), &item.attrs, true);
                }
                Item::Impl(item) if is_compiled(&item.attrs) => {
                    let is_default = item
                        .trait_
                        .as_ref()
                        .is_some_and(|(_, path, _)| path.is_ident("Default"));
                    if let Type::Path(of) = &*item.self_ty
                        && is_default
                        && let Some(last) = of.path.segments.last()
                    {
                        self.with_default.insert(last.ident.to_string());
                    }
                }
                Item::Mod(item) if is_compiled(&item.attrs) => {
                    let name = item.ident.to_string();
                    let below = folder.join(&name);
                    match &item.content {
                        Some((_, items)) => self.collect(items, &below),
                        None => {
                            let file = folder.join(format!("{name}.rs"));
                            let file: PathBuf = if file.exists() { file } else { below.join("mod.rs") };
                            self.read(&file, &below);
                        }
                    }
                }
                _ => {}
            }
        }
    }

    fn declare(&mut self, visibility: &Visibility, name: &str, attributes: &[Attribute], is_enum: bool) {
        if matches!(visibility, Visibility::Public(_)) {
            let mut derives = HashSet::new();
            attributes
                .iter()
                .for_each(|attribute| add_derives(&attribute.meta, &mut derives));
            self.types.push(Declared {
                name: name.into(),
                derives,
                is_enum,
                has_default: false,
            });
        }
    }
}

/// Adds what `derive(...)` names, also in `cfg_attr(...)`.
fn add_derives(attribute: &Meta, derives: &mut HashSet<String>) {
    if attribute.path().is_ident("derive") {
        for path in arguments(attribute) {
            let last = path.path().segments.last().expect("a path has segments");
            derives.insert(last.ident.to_string());
        }
    } else if attribute.path().is_ident("cfg_attr") {
        let arguments = arguments(attribute);
        let (condition, attributes) = arguments.split_first().expect("cfg_attr has a condition");
        if holds(condition) {
            attributes.iter().for_each(|attribute| add_derives(attribute, derives));
        }
    }
}

fn is_compiled(attributes: &[Attribute]) -> bool {
    let mut conditions = attributes.iter().filter(|attribute| attribute.path().is_ident("cfg"));
    conditions.all(|attribute| arguments(&attribute.meta).iter().all(holds))
}

fn arguments(list: &Meta) -> Vec<Meta> {
    let list = list.require_list().expect("a list");
    let parsed = list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
    parsed.expect("attributes").into_iter().collect()
}

/// Whether the condition of a `cfg` holds for the library under test.
fn holds(condition: &Meta) -> bool {
    let path = condition.path();
    if path.is_ident("all") {
        return arguments(condition).iter().all(holds);
    }
    if path.is_ident("any") {
        return arguments(condition).iter().any(holds);
    }
    if path.is_ident("not") {
        return !arguments(condition).iter().any(holds);
    }
    if path.is_ident("test") {
        return false;
    }
    assert!(
        path.is_ident("feature"),
        "this test does not know the condition of a cfg"
    );
    let value = &condition.require_name_value().expect("feature = \"name\"").value;
    let syn::Expr::Lit(syn::ExprLit {
        lit: syn::Lit::Str(name),
        ..
    }) = value
    else {
        panic!("the name of a feature is not a string");
    };
    is_on(&name.value())
}

fn is_on(feature: &str) -> bool {
    match feature {
        "bevy" => cfg!(feature = "bevy"),
        "bevy_gltf" => cfg!(feature = "bevy_gltf"),
        "bevy_mesh" => cfg!(feature = "bevy_mesh"),
        "bevy_picking" => cfg!(feature = "bevy_picking"),
        "bevy_render" => cfg!(feature = "bevy_render"),
        "bevy_scene" => cfg!(feature = "bevy_scene"),
        "cli" => cfg!(feature = "cli"),
        "debug_gizmos" => cfg!(feature = "debug_gizmos"),
        "debug_panel" => cfg!(feature = "debug_panel"),
        "gpu" => cfg!(feature = "gpu"),
        "interpolation" => cfg!(feature = "interpolation"),
        _ => panic!("this test does not know the feature {feature}"),
    }
}
