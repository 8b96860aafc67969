//! Things that stand on the carpet and walk away: where one stood, other pictures show plain carpet.

use glam::DVec2;

use crate::{
    passing::{is_green_carpet, is_outlying},
    report::Unexplained,
    rows::Channel,
    unknown::Residuals,
};

/// A foot and the carpet around it are one place within this distance, metres.
const NEAR_M: f64 = 0.25;
/// The place is seen in so many blocks at least: from far away a thing hides a part of one.
const LEAST_SPOTS: usize = 2;
/// Pictures closer in time show a walker in the same place, seconds.
const LATER_S: f64 = 1.0;
/// The place is seen in so many other pictures at least.
const LEAST_SEEN: usize = 3;
/// And is plain carpet in this part of them at least.
const CLEAR: f64 = 0.7;
/// Feet that are gone at other times, in this part of the pictures at least, are worth a word: a thing's side is taken for
/// its foot now and then.
const LEAST_PART: f64 = 0.2;

/// A block of carpet, or of what hides it.
#[derive(Debug, Clone, Copy)]
struct Spot {
    pixel: DVec2,
    ground: DVec2,
    is_hidden: bool,
}

/// What a picture shows of the carpet.
struct Scene {
    time_s: f64,
    spots: Vec<Spot>,
    /// Between neighbouring blocks, pixels.
    pitch_px: f64,
}

/// Things that are not where they were in other pictures. `sigma` is the carpet's standard deviation.
pub(crate) fn moving(frames: &[Residuals<'_>], sigma: f64) -> Option<Unexplained> {
    let scenes: Vec<Scene> = frames.iter().map(|frame| Scene::new(frame, sigma)).collect();
    let with_walker =
        scenes.iter().filter(|scene| scene.feet().any(|foot| is_left(&scenes, scene.time_s, foot))).count();
    let part = with_walker as f64 / scenes.len().max(1) as f64;
    (part > LEAST_PART).then(|| Unexplained {
        channel: Channel::Photometry.name().to_owned(),
        r#where: format!(
            "things that move: in {:.0} % of the pictures something stands on the carpet where others show it plain",
            100.0 * part
        ),
        size: part,
        unit: "1".to_owned(),
        p_value: None,
    })
}

impl Scene {
    fn new(frame: &Residuals<'_>, sigma: f64) -> Self {
        let rows = frame.rows.iter().zip(&frame.values);
        let spots: Vec<Spot> = rows
            .filter(|(row, value)| is_green_carpet(row) && value.is_finite())
            .map(|(row, value)| Spot {
                pixel: row.pixel,
                ground: row.ground,
                is_hidden: is_outlying(*value, sigma),
            })
            .collect();
        let pitch_px = spots
            .windows(2)
            .map(|pair| pair[1].pixel.x - pair[0].pixel.x)
            .filter(|step| *step > 0.5)
            .fold(f64::INFINITY, f64::min);
        Self { time_s: frame.time_s, spots, pitch_px }
    }

    /// Where things touch the carpet: hidden, and just below in the picture there is plain carpet and nothing of the same
    /// thing, whose sides may slant.
    fn feet(&self) -> impl Iterator<Item = DVec2> {
        let is_foot = move |spot: &&Spot| {
            let below = spot.pixel + DVec2::new(0.0, self.pitch_px);
            let next_row = self.spots.iter().filter(|other| {
                (other.pixel.y - below.y).abs() < 0.5 && (other.pixel.x - below.x).abs() < 1.5 * self.pitch_px
            });
            let (hidden, plain): (Vec<&Spot>, Vec<&Spot>) = next_row.partition(|other| other.is_hidden);
            spot.is_hidden && hidden.is_empty() && plain.iter().any(|other| other.pixel.distance(below) < 0.5)
        };
        self.spots.iter().filter(is_foot).map(|spot| spot.ground)
    }
}

/// Whether other pictures show plain carpet where a thing stood at a time.
fn is_left(scenes: &[Scene], time_s: f64, foot: DVec2) -> bool {
    let (mut seen, mut clear) = (0, 0);
    for scene in scenes.iter().filter(|scene| (scene.time_s - time_s).abs() > LATER_S) {
        let around: Vec<&Spot> =
            scene.spots.iter().filter(|spot| spot.ground.distance(foot) < NEAR_M).collect();
        if around.len() >= LEAST_SPOTS {
            seen += 1;
            clear += usize::from(around.iter().all(|spot| !spot.is_hidden));
        }
    }
    seen >= LEAST_SEEN && clear as f64 >= CLEAR * seen as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{rows::Row, testing::carpet_row};

    const SIGMA: f64 = 0.05;
    const PITCH_PX: f64 = 8.0;
    const COUNT: i32 = 20;

    /// A picture from straight above, ten blocks a metre, with things of two by three blocks whose nearest left block is
    /// given in metres.
    fn picture(time_s: f64, things: &[DVec2]) -> (Vec<Row>, Vec<f64>, f64) {
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for v in 0..COUNT {
            for u in 0..COUNT {
                let pixel = PITCH_PX * DVec2::new(f64::from(u), f64::from(v));
                // Up in the picture is forward.
                let ground = DVec2::new(f64::from(u), f64::from(COUNT - v)) * 0.1;
                let is_inside = |thing: &DVec2| {
                    let inside = ground - *thing;
                    (-0.01..0.15).contains(&inside.x) && (-0.01..0.25).contains(&inside.y)
                };
                rows.push(carpet_row(pixel, ground));
                values.push(if things.iter().any(is_inside) { -1.0 } else { 0.3 * SIGMA });
            }
        }
        (rows, values, time_s)
    }

    fn judged(things: impl Fn(f64) -> Vec<DVec2>) -> Option<Unexplained> {
        let pictures: Vec<_> =
            (0..20).map(|i| picture(0.2 * f64::from(i), &things(0.2 * f64::from(i)))).collect();
        let frames: Vec<Residuals<'_>> = pictures
            .iter()
            .map(|(rows, values, time_s)| Residuals {
                rows,
                values: values.clone(),
                time_s: *time_s,
                size: [160, 160],
            })
            .collect();
        moving(&frames, SIGMA)
    }

    #[test]
    fn who_walks_over_the_carpet_is_seen_and_in_how_many_pictures() {
        let found = judged(|time_s| vec![DVec2::new(0.3 + 0.3 * time_s, 0.9)]).unwrap();
        assert!(found.size > 0.8, "{}", found.size);
        assert!(found.r#where.contains("things that move"), "{}", found.r#where);
    }

    #[test]
    fn what_stays_where_it_is_does_not_move() {
        assert_eq!(judged(|_| vec![DVec2::new(0.7, 0.9), DVec2::new(1.2, 0.4)]), None);
        assert_eq!(judged(|_| Vec::new()), None);
    }

    #[test]
    fn a_glimpse_is_not_enough() {
        let glimpse = |time_s: f64| if time_s < 0.5 { vec![DVec2::new(0.7, 0.9)] } else { Vec::new() };
        assert_eq!(judged(glimpse), None);
    }
}
