//! `--gif FILE`: saves the window as a moving picture, of a size that suits a README.
//!
//! A frame of the picture is a frame of the window and a fixed number of steps, however long the machine takes for
//! them.

use super::window::Waiting;
use super::{Options, STEP};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use image::{Rgb, RgbImage};
use std::error::Error;
use std::fs::File;
use std::path::Path;

/// Frames, unless `--frames` says otherwise.
const FRAMES: u32 = 80;
/// Steps from frame to frame.
const STEPS: u32 = 3;
/// How long a frame is shown, hundredths of a second. Three steps are 4.7.
const DELAY: u16 = 5;
/// Width and height of the window and the picture, pixels.
pub const SIZE: (u32, u32) = (480, 300);
/// Colours of the picture. One more says that a pixel stays as it is.
const COLORS: usize = 127;
/// Frames of the window before the first of the picture, in which the renderer gets ready. Time stands still meanwhile.
const WARM_UP: u32 = 10;

/// Records the window if there is `--gif`.
pub struct GifPlugin;

impl Plugin for GifPlugin {
    fn build(&self, app: &mut App) {
        if app.world().resource::<Options>().gif.is_some() {
            app.init_resource::<Film>()
                .insert_resource(TimeUpdateStrategy::ManualDuration(default()))
                .add_systems(Last, (expose, develop).chain())
                .add_observer(collect);
        }
    }
}

/// The pictures so far.
#[derive(Resource, Default)]
struct Film {
    /// Frames of the window since all bodies are visible.
    frame: u32,
    /// Pictures that were asked for. They may arrive in another order.
    asked: Vec<Entity>,
    pictures: Vec<(Entity, RgbImage)>,
}

/// Asks for a picture of each frame.
fn expose(
    mut commands: Commands,
    mut film: ResMut<Film>,
    mut time: ResMut<TimeUpdateStrategy>,
    options: Res<Options>,
    waiting: Waiting,
) {
    if film.frame == 0 && !waiting.is_empty() {
        return;
    }
    film.frame += 1;
    if film.frame < WARM_UP {
        return;
    }
    *time = TimeUpdateStrategy::ManualDuration(STEPS * STEP);
    let first = WARM_UP + options.skip;
    if (first..first + options.frames.unwrap_or(FRAMES)).contains(&film.frame) {
        film.asked.push(commands.spawn(Screenshot::primary_window()).id());
    }
}

fn collect(shot: On<ScreenshotCaptured>, mut film: ResMut<Film>) {
    let picture = match shot.image.clone().try_into_dynamic() {
        // Without the alpha channel, which holds something else with `Hdr`.
        Ok(image) => image.to_rgb8(),
        Err(error) => {
            error!("{error}");
            default()
        }
    };
    film.pictures.push((shot.entity, picture));
}

/// Writes the file once all pictures are there, and ends the app.
fn develop(mut film: ResMut<Film>, options: Res<Options>, mut exit: MessageWriter<AppExit>) {
    let frames = options.frames.unwrap_or(FRAMES) as usize;
    let (Some(path), true) = (&options.gif, film.pictures.len() == frames) else {
        return;
    };
    let Film {
        asked, mut pictures, ..
    } = std::mem::take(&mut *film);
    pictures.sort_by_key(|(entity, _)| asked.iter().position(|asked| asked == entity));
    let pictures: Vec<_> = pictures.into_iter().map(|(_, picture)| picture).collect();
    exit.write(match write(path, &pictures) {
        Ok(()) => AppExit::Success,
        Err(error) => {
            eprintln!("{}: {error}", path.display());
            AppExit::error()
        }
    });
}

/// Writes a file with one palette for all frames. What stays the same from frame to frame is left out.
fn write(path: &Path, pictures: &[RgbImage]) -> Result<(), Box<dyn Error>> {
    let Some(first) = pictures.first() else { return Ok(()) };
    let (width, height) = (first.width() as u16, first.height() as u16);
    let opaque = |pixel: &Rgb<u8>| [pixel[0], pixel[1], pixel[2], u8::MAX];
    // Some frames and some pixels of each are enough.
    let some = pictures
        .iter()
        .step_by(8)
        .flat_map(|picture| picture.pixels().step_by(3));
    let quantizer = NeuQuant::new(1, COLORS, some.map(opaque).collect::<Vec<_>>().as_flattened());
    let mut palette = quantizer.color_map_rgb();
    palette.extend([0; 3]);
    let mut encoder = Encoder::new(File::create(path)?, width, height, &palette)?;
    encoder.set_repeat(Repeat::Infinite)?;
    let same = COLORS as u8;
    let mut shown = vec![same; first.pixels().len()];
    for picture in pictures {
        let changed = shown.iter_mut().zip(picture.pixels()).map(|(shown, pixel)| {
            let color = quantizer.index_of(&opaque(pixel)) as u8;
            if std::mem::replace(shown, color) == color {
                same
            } else {
                color
            }
        });
        encoder.write_frame(&Frame {
            delay: DELAY,
            dispose: DisposalMethod::Keep,
            transparent: Some(same),
            width,
            height,
            buffer: changed.collect(),
            ..Frame::default()
        })?;
    }
    Ok(())
}
