//! What is wished for, what has come of it, and the screen.

use std::time::Duration;

use glam::DVec2;

use super::{BakeState, Effect, Program};
use crate::frame::EncodedImage;
use crate::output::terminal::{Area, Cells, PixelPicture};
use crate::preview::hands::Seen;
use crate::preview::painter::{Drawn, Sharpness, Wish};
use crate::preview::panel;
use crate::preview::prepare::Wanted;
use crate::preview::view::View;
use crate::relight::{Effort, FrameSettings, Quality};
use crate::scene::{Camera, Material};

impl Program {
    /// A picture has come.
    pub(super) fn look(&mut self, number: u64, drawn: Drawn, now: Duration) -> Vec<Effect> {
        let lacks_bake = drawn.lacks_bake || drawn.lacks_folding || drawn.lacks_slices_of.is_some();
        let lacks_bake = lacks_bake && self.bake == BakeState::Settled;
        self.oldest = number;
        self.status.drew(&drawn, now);
        if drawn.sharpness == Sharpness::Fine {
            if number == self.wishes {
                self.fine = Some(drawn);
            }
        } else {
            self.fine = None;
            self.drawn = Some(drawn);
        }
        if lacks_bake {
            // What is shown now needs it; what the scene file asks for did not.
            return vec![self.prepare(true)];
        }
        Vec::new()
    }

    /// The same, and none of what was wished for before: of another size or scene.
    pub(super) fn show_anew(&mut self) -> Option<Effect> {
        let effect = self.show();
        self.oldest = self.wishes;
        effect
    }

    /// Pictures of the scene as it is now, if they are others than those that are
    /// on their way.
    pub(super) fn show(&mut self) -> Option<Effect> {
        let wish = self.wish();
        if self.wished.as_ref() == Some(&wish) {
            return None;
        }
        self.wished = Some(wish.clone());
        self.wishes += 1;
        self.fine = None;
        Some(Effect::Show(self.wishes, Box::new(wish)))
    }

    /// The scene made ready; with its bake, whatever the file asks for, if told so.
    pub(super) fn prepare(&mut self, bake: bool) -> Effect {
        self.preparations += 1;
        self.bake = BakeState::OnItsWay;
        self.status.baking = Some(("reading the mesh", 0.0));
        let wanted = Wanted {
            number: self.preparations,
            bake,
        };
        // Of materials as they are now: a bake has slices for those with a lobe, and
        // with a fixed albedo its bounces are folded under theirs.
        let mut scene = self.scene.clone();
        scene.materials = self.materials();
        Effect::Prepare(wanted, Box::new(scene))
    }

    /// The materials as they are edited.
    fn materials(&self) -> Vec<Material> {
        let mut materials = self.scene.materials.clone();
        let reflections = &self.hands.document().reflections;
        for (material, reflection) in materials.iter_mut().zip(reflections) {
            reflection.apply(material);
        }
        materials
    }

    /// What is to be seen.
    pub(crate) fn wish(&self) -> Wish {
        let document = self.hands.document();
        let view = self.view();
        let mut camera = document.camera;
        camera.size = view.size_px;
        let fine_size = self.cell_px.map(|(width, height)| {
            [(view.columns, width), (view.rows, height)]
                .map(|(cells, px)| u32::from(cells) * u32::from(px))
        });
        Wish {
            lights: document.shown_lights(),
            materials: self.materials(),
            frame: FrameSettings {
                camera,
                bounces: document.render.bounces,
                light_samples: document.render.light_samples,
                component: document.component,
                effort: Effort::Full,
                quality: Quality::Standard,
            },
            exposure: document.render.exposure,
            tone: document.render.tone,
            fine_size,
        }
    }

    /// Where the picture is: above the status line, which goes first where there
    /// is hardly any room.
    pub(crate) fn view(&self) -> View {
        let (columns, rows) = self.size;
        let picture_rows = if rows > 1 { rows - 1 } else { rows };
        let side = |cells: u16, px: u32| u32::from(cells.max(1)) * px;
        View {
            column: 0,
            row: 0,
            columns,
            rows: picture_rows,
            size_px: [side(columns, 1), side(picture_rows, 2)],
            extent: self.extent,
        }
    }

    /// The screen.
    pub(crate) fn cells(&self) -> Cells {
        let (columns, rows) = self.size;
        let mut cells = Cells::new(columns, rows);
        let view = self.view();
        match self.marked() {
            Some(marked) => cells.picture(view.row, &marked),
            None => panel::waiting(&mut cells, &self.status),
        }
        if let Some(first) = self.help {
            panel::help(&mut cells, first);
        }
        let bottom = match &self.prompt {
            Some(prompt) => panel::Bottom::Question(prompt.text()),
            None if self.help.is_some() => panel::Bottom::Question(panel::HELP_KEYS),
            None => panel::Bottom::Status {
                status: &self.status,
                selected: self.hands.selected_name(),
                is_unsaved: self.hands.is_unsaved(),
            },
        };
        panel::bottom(&mut cells, &bottom);
        cells
    }

    /// The picture in pixels, once the scene rests and nothing lies over it.
    pub(crate) fn pixel_picture(&self) -> Option<PixelPicture> {
        let fine = self.fine.as_ref().filter(|_| self.help.is_none())?;
        let view = self.view();
        let mut fine_view = view;
        fine_view.size_px = [fine.levels.width(), fine.levels.height()];
        Some(PixelPicture {
            levels: self.hands.with_marks(&fine.levels, &fine_view),
            area: Area {
                column: view.column,
                row: view.row,
                columns: view.columns,
                rows: view.rows,
            },
        })
    }

    /// The last picture in cells, with the marks of lights.
    pub(crate) fn marked(&self) -> Option<EncodedImage> {
        let drawn = self.drawn.as_ref()?;
        Some(self.hands.with_marks(&drawn.levels, &self.view()))
    }

    /// Whether there is something to save.
    pub(crate) fn is_unsaved(&self) -> bool {
        self.hands.is_unsaved()
    }
}

/// What is seen at pixel coordinates of the view.
pub(super) fn seen_at(drawn: &Drawn, view: &View, camera: &Camera, px: DVec2) -> Option<Seen> {
    let [width, height] = drawn.seen.size;
    let at = |place: f64, of: u32, count: u32| {
        let scaled = place / f64::from(of) * f64::from(count);
        (scaled >= 0.0 && scaled < f64::from(count)).then_some(scaled as usize)
    };
    let x = at(px.x, view.size_px[0], width)?;
    let y = at(px.y, view.size_px[1], height)?;
    let pixel = y * width as usize + x;
    let depth = f64::from(*drawn.seen.depths.get(pixel)?);
    let material = drawn.seen.materials.get(pixel).copied().flatten()?;
    Some(Seen {
        material: material as usize,
        point: view.eye(camera).point_at(px, depth),
    })
}
