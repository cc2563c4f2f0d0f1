//! The generator of the meshes and pictures in `scenes/`.
//!
//! One file a scene; [`body`], [`cells`], [`extrusion`], [`rings`] and
//! [`profile`] are what they are built from, [`obj`] prints them, [`topology`]
//! checks them and [`pictures`] paints what lies beside them.
//! Elementary functions come from `libm`, so the bytes are the same everywhere.

pub(crate) mod body;
mod cells;
mod cornell;
mod courtyard;
mod extrusion;
mod glossy;
pub(crate) mod model;
pub(crate) mod obj;
pub(crate) mod pictures;
mod plank;
mod profile;
mod rings;
mod room;
pub(crate) mod sheet;
pub(crate) mod sphere;
pub(crate) mod statues;
pub(crate) mod topology;
mod window;

use model::Model;

/// Every scene of `scenes/`.
pub(crate) fn all() -> Vec<Model> {
    vec![
        cornell::model(),
        window::model(),
        statues::model(),
        plank::model(),
        sphere::model(),
        sheet::model(),
        courtyard::model(),
        glossy::model(),
    ]
}
