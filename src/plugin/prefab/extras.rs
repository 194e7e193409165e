//! Settings in the `extras` of glTF files. [`prefab`](super) has the table of properties.

use super::error::PropertyError;
use super::settings::Layer;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::plugin::components::{Density, Mass};
use crate::types::body::{CollisionLayers, RigidBody};
use crate::types::material::{Friction, Restitution};
use serde_json::Value;

const COLLIDER: &str = "faceoff";
const BODY: &str = "faceoff_body";
const MASS: &str = "faceoff_mass";
const DENSITY: &str = "faceoff_density";
const FRICTION: &str = "faceoff_friction";
const RESTITUTION: &str = "faceoff_restitution";
const LAYERS: &str = "faceoff_layers";
const FILTERS: &str = "faceoff_filters";
const ROUNDING: &str = "faceoff_rounding";

/// All properties.
pub(super) const KNOWN: [&str; 9] = [
    COLLIDER,
    BODY,
    MASS,
    DENSITY,
    FRICTION,
    RESTITUTION,
    LAYERS,
    FILTERS,
    ROUNDING,
];

/// What has properties.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ExtrasOwner {
    /// A node with or without a mesh of its own.
    Node { has_mesh: bool },
    /// A mesh, a primitive or a material.
    Mesh,
}

/// Reads the properties of one object, mesh or material.
pub(super) fn read(json: &str, owner: ExtrasOwner) -> (Layer, Vec<PropertyError>) {
    let (mut layer, mut errors) = (Layer::default(), Vec::new());
    // Extras that are not an object of properties belong to others.
    let Ok(Value::Object(properties)) = serde_json::from_str(json) else {
        return (layer, errors);
    };
    let has_body = properties.contains_key(BODY);
    for (key, value) in &properties {
        if !is_ours(key) {
            continue;
        }
        let result = match owner {
            ExtrasOwner::Mesh if [BODY, MASS].contains(&&**key) => Err(PropertyError::NotOnNode(key.clone())),
            ExtrasOwner::Node { .. } if key == MASS && !has_body => Err(PropertyError::NoBody(key.clone())),
            ExtrasOwner::Node { has_mesh: false } if key != BODY && !has_body => {
                Err(PropertyError::NoMesh(key.clone()))
            }
            _ => set(&mut layer, key, value),
        };
        errors.extend(result.err());
    }
    (layer, errors)
}

/// Whether a property is meant for this crate.
fn is_ours(key: &str) -> bool {
    key.strip_prefix(COLLIDER)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with(['_', '-', ' ', '.']))
}

fn set(layer: &mut Layer, key: &str, value: &Value) -> Result<(), PropertyError> {
    let wrong = |expected| PropertyError::Value {
        key: key.into(),
        value: value.to_string(),
        expected,
    };
    let number = |is_valid: fn(f32) -> bool, expected| {
        let number = value.as_f64().map(|number| number as f32);
        number
            .filter(|&number| number.is_finite() && is_valid(number))
            .ok_or(wrong(expected))
    };
    let settings = &mut layer.settings;
    match key {
        COLLIDER => match value {
            Value::Bool(collider) => layer.collider = Some(*collider),
            Value::String(text) if text == "none" => layer.collider = Some(false),
            Value::String(text) if text == "collider" => layer.collider = Some(true),
            Value::String(text) if text == "sensor" => {
                layer.collider = Some(true);
                settings.sensor = Some(true);
            }
            _ => return Err(wrong("\"none\", \"collider\" or \"sensor\"")),
        },
        BODY => {
            settings.body = Some(match value.as_str() {
                Some("dynamic") => RigidBody::Dynamic,
                Some("kinematic") => RigidBody::Kinematic,
                Some("static") => RigidBody::Static,
                _ => return Err(wrong("\"dynamic\", \"kinematic\" or \"static\"")),
            });
        }
        MASS => settings.mass = Some(Mass(number(|m| m > 0.0, "a number of kilograms above 0")?)),
        DENSITY => {
            settings.density = Some(Density(number(|d| d > 0.0, "a number of kg/m^3 above 0")?));
        }
        FRICTION => settings.friction = Some(Friction::new(number(|f| f >= 0.0, "a number of 0 or more")?)),
        RESTITUTION => {
            let number = number(|r| (0.0..=1.0).contains(&r), "a number from 0 to 1")?;
            settings.restitution = Some(Restitution::new(number));
        }
        ROUNDING => {
            let is_valid = |r: f32| (0.0..=MAX_COORDINATE).contains(&r);
            settings.rounding = Some(number(is_valid, "a number of mesh units, 0 or more")?);
        }
        LAYERS | FILTERS => {
            let bits = layer_bits(value).ok_or(wrong("a layer from 0 to 31, or a list of them"))?;
            let layers = settings.layers.get_or_insert_with(CollisionLayers::default);
            if key == LAYERS {
                layers.memberships = bits;
            } else {
                layers.filters = bits;
            }
        }
        _ => return Err(PropertyError::Unknown(key.into())),
    }
    Ok(())
}

/// The bits of a layer or of a list of layers.
fn layer_bits(value: &Value) -> Option<u32> {
    let bit = |value: &Value| {
        // Blender writes lists of integers as integers, but scripts may write floats.
        let layer = value.as_f64().filter(|layer| layer.fract() == 0.0)?;
        (0.0..32.0).contains(&layer).then(|| 1_u32 << layer as u32)
    };
    match value {
        Value::Array(layers) => layers.iter().try_fold(0, |bits, layer| Some(bits | bit(layer)?)),
        _ => bit(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(json: &str) -> (Layer, Vec<PropertyError>) {
        read(json, ExtrasOwner::Node { has_mesh: true })
    }

    #[test]
    fn every_property_is_read() {
        let (layer, errors) = node(
            r#"{"faceoff": "sensor", "faceoff_body": "kinematic", "faceoff_mass": 3, "faceoff_density": 2.5,
                "faceoff_friction": 0, "faceoff_restitution": 1.0, "faceoff_layers": 3, "faceoff_filters": [0, 31.0],
                "height": "high", "faceoffs": 7}"#,
        );
        assert_eq!(errors, []);
        let settings = &layer.settings;
        assert_eq!(layer.collider, Some(true));
        assert_eq!(settings.sensor, Some(true));
        assert_eq!(
            (settings.body, settings.mass),
            (Some(RigidBody::Kinematic), Some(Mass(3.0)))
        );
        assert_eq!(settings.density, Some(Density(2.5)));
        assert_eq!(settings.friction, Some(Friction::new(0.0)));
        assert_eq!(settings.restitution, Some(Restitution::new(1.0)));
        let layers = settings.layers.unwrap();
        assert_eq!((layers.memberships, layers.filters), (8, 0x8000_0001));
    }

    #[test]
    fn a_collider_is_wanted_or_not() {
        for (value, wanted) in [
            ("\"none\"", false),
            ("false", false),
            ("\"collider\"", true),
            ("true", true),
        ] {
            let (layer, errors) = node(&format!("{{\"faceoff\": {value}}}"));
            assert_eq!((layer.collider, errors.len()), (Some(wanted), 0), "{value}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_told_and_the_rest_holds() {
        for bad in [
            r#""faceoff": "no""#,
            r#""faceoff_body": "rigid""#,
            r#""faceoff_density": 0"#,
            r#""faceoff_density": "2""#,
            r#""faceoff_density": 1e300"#,
            r#""faceoff_friction": -1"#,
            r#""faceoff_restitution": 1.5"#,
            r#""faceoff_layers": 32"#,
            r#""faceoff_layers": [0.5]"#,
            r#""faceoff_filters": {}"#,
            r#""faceoff_densty": 1"#,
            r#""faceoff_mass": 1"#,
        ] {
            let (layer, errors) =
                node(&format!("{{{bad}, \"faceoff\": true}}").replace("\"no\", \"faceoff\": true", "\"no\""));
            let key = bad.split('"').nth(1).unwrap();
            assert_eq!(errors.len(), 1, "{bad}");
            assert!(errors[0].to_string().contains(key), "{}", errors[0]);
            assert_eq!(layer.settings, default(), "{bad}");
        }
    }

    fn default() -> super::super::ColliderSettings {
        super::super::ColliderSettings::default()
    }

    #[test]
    fn what_has_no_effect_is_told() {
        let body = r#"{"faceoff_body": "dynamic"}"#;
        assert_eq!(read(body, ExtrasOwner::Mesh).1, [PropertyError::NotOnNode(BODY.into())]);
        let empty = ExtrasOwner::Node { has_mesh: false };
        assert_eq!(read(body, empty).1, []);
        let density = r#"{"faceoff_density": 2}"#;
        assert_eq!(read(density, empty).1, [PropertyError::NoMesh(DENSITY.into())]);
        assert_eq!(
            read(r#"{"faceoff_density": 2, "faceoff_body": "dynamic"}"#, empty).1,
            []
        );
    }

    #[test]
    fn extras_of_others_are_left_alone() {
        for other in ["7", "[]", "\"faceoff\"", "{\"targetNames\": [\"a\"]}", "not json"] {
            assert_eq!(node(other), (Layer::default(), vec![]), "{other}");
        }
    }
}
