//! Scenes that combine features, and identities in place of bounds: what two computations that must
//! agree give for the same scene.
//!
//! ```text
//! features     the table of features, and scenes in which every pair of them occurs
//! scene        a scene of these features: its numbers, its text and its forces
//! views        the same scene in a mirror, in other units, from a later start
//! equivalents  one force written in two ways; mirror images, other units, a later start, parts of time
//! steps        the schemes with a step against plain loops on the same draws
//! motion       the schemes without a step against a plain integrator on the same noise
//! ensembles    parts, sessions, threads, lanes and pairs; statistics from the rows of paths
//! ```
//!
//! Every scene is simulated by every scheme that suits it ([`scene::Scene::in_scheme`] states what a
//! scheme leaves out). A scene that fails is printed by its name and as TOML.

#[path = "../common/mod.rs"]
mod common;

mod ensembles;
mod equivalents;
mod features;
mod motion;
mod scene;
mod steps;
mod views;
