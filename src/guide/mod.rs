//! Guides: how it works, how to choose settings, what changes for those who come from another engine, and what to do about
//! surprises.
//!
//! | you want to | read |
//! |---|---|
//! | know what it does, in pictures | [`how_it_works`] |
//! | decide between this, Avian and bevy_rapier | [`comparison`] |
//! | set the plugin up for your kind of game, server or tool; a first program with a window; where to put systems | [`choose_settings`] |
//! | write bodies in `bsn!`, or save a world and load it again | [`scenes`] |
//! | move a game from Avian | [`from_avian`] |
//! | move a game from bevy_rapier | [`from_bevy_rapier`] |
//! | understand a warning, an error or a surprise | [`troubleshooting`] |
//! | look up a word, a limit or a built-in shape | [`glossary`] |
//!
//! The README has the tables of everything that there is, and the examples are programs to start from.

pub mod choose_settings;
pub mod comparison;
pub mod from_avian;
pub mod from_bevy_rapier;
pub mod glossary;
pub mod how_it_works;
pub mod scenes;
pub mod troubleshooting;
