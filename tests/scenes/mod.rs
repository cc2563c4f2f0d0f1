//! The generator of the meshes in `scenes/`.
//!
//! One file a scene; [`body`], [`cells`], [`rings`] and [`profile`] are what
//! they are built from, [`obj`] prints them and [`topology`] checks them.
//! Elementary functions come from `libm`, so the bytes are the same everywhere.

pub(crate) mod body;
mod cells;
mod cornell;
pub(crate) mod model;
pub(crate) mod obj;
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
    ]
}
