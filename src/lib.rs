//! relume relights scenes on a CPU: it precomputes how diffuse light travels
//! between the surfaces of an OBJ scene and then renders multi-bounce indirect
//! light for any light, albedo and view in milliseconds.
//!
//! The way of the data, one room a stage; a room imports only from rooms above
//! it in this list:
//!
//! | room | what it does |
//! |---|---|
//! | `simd` | kernels with a scalar definition each; the only `unsafe` |
//! | `maths` | elementary functions and sampling points, the same bits everywhere |
//! | `brdf` | how surfaces reflect: the glossy lobe and its tables |
//! | `texture` | image maps: decoded once, filtered, looked up |
//! | `scene` | what the user wrote: OBJ/MTL, TOML, lights, materials, camera |
//! | `frame` | linear images, tone curves, FLIP and other measures of difference |
//! | `compare` | two images judged: limits, masks, what fails, what would pass |
//! | `report` | tables, plots and pictures as one folder of files, as bytes |
//! | `surface` | tessellation, lighting vertices, sides, rays |
//! | `bake` | partitions, spectral basis, sampled transfer, compressed rows, bake file |
//! | `relight` | direct light, bounces, rasterizer, shading |
//! | `reference` | path tracer: the truth that everything is measured against |
//! | `output` | PNG and EXR files, heat maps, terminals, folders of files |
//! | `golden` | scenes and frames held against golden images, and the report on it |
//! | `measure` | how long frames take, and how wrong they are for it |
//! | `preview` | the interactive terminal program |
//!
//! ```no_run
//! use relume::{FrameSettings, Renderer, RunSettings, Scene};
//!
//! let scene = Scene::load("scenes/cornell/cornell.toml".as_ref(), &[])?;
//! let settings = FrameSettings::of_scene(&scene);
//! let mut renderer = Renderer::new(scene, None);
//! let frame = renderer.frame(&settings, &RunSettings::silent())?;
//! println!("{} x {}", frame.image.width(), frame.image.height());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bake;
mod brdf;
mod compare;
mod frame;
pub mod golden;
mod maths;
pub mod measure;
mod output;
pub mod preview;
pub mod reference;
mod relight;
pub mod report;
mod scene;
mod simd;
mod surface;
mod texture;

pub use bake::{
    BakeError, BakeForecast, BakeSettings, BakeStats, ErrorParts, FreeKeys, LightErrors,
    Partitioner, Progress, RunSettings, Scheme, Silent, ThreadPool, ThreadPoolError, thread_pool,
};
pub use brdf::{Gloss, NAMED_BRDFS, NamedBrdf};
pub use compare::{
    ComparedImage, Failure, Figure, Figures, FlipMeasure, HeatScale, JudgeError, Judgement, Limits,
    Mask, MaskError, Measured, PassingLimits, judge, strip,
};
pub use frame::{
    Difference, EncodedImage, FlipMap, HdrFlip, Image, ImageSizeError, LoadedImage, Metadata,
    MetadataDifference, PIXELS_PER_DEGREE, SizeMismatch, compare, flip, hdr_flip,
};
pub use output::{
    OutputError, Picture, PictureMetadata, check_format, encode_described, encode_png, heat_map,
    read_compared, read_image, write_described, write_file, write_folder, write_picture, write_png,
};
pub use relight::{
    BakeFigures, BasisFunction, BasisFunctionError, BounceError, COMPONENTS, Component,
    ComponentError, Effort, Frame, FrameSettings, ImageCounts, LightCounts, Outlook, Quality,
    QualityError, RenderError, Renderer, SceneContents, SceneFigures, SeenSurfaces, SkyView,
    Stages, bounces_text, describe_levels, describe_scene, develop,
};
pub use scene::{
    Animation, Area, BakeKeys, Bounces, Camera, Directional, Environment, GoldenKeys, Light,
    LightKind, Material, Mesh, MeshTriangle, Override, PixelLimit, Point, Radiance, RenderKeys,
    Scene, SceneError, Spot, Tone,
};
pub use simd::Level as SimdLevel;
pub use texture::{EnvironmentMap, Texture, TextureError, TextureFilter, TextureMap};
