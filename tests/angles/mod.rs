//! The angles at which bodies see each other, and the faces that are culled by them.

mod modes;
