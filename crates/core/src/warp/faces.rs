//! Surfaces of the proxy geometry that a cell may show, and where the rays of its nodes meet each of them.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{
    Target,
    edges::{Edges, Meeting},
    kernel::{FIRST_BILLBOARD, GROUND, Placement, ProxyPoints},
    proxy_geometry::ProxyGeometry,
    smooth::range,
};
use crate::camera::{LANES, Lanes};

/// Largest number of surfaces for which a cell's maps are made: the border of two, or a post before two others.
pub(crate) const MOST_FACES: usize = 3;

/// Numbers of the surfaces that a cell may show.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Faces {
    numbers: [f32; MOST_FACES],
    count: usize,
}

impl Faces {
    /// Finds the surfaces that the nodes see, and those that may lie between them; `None` if there are too many, if a node sees
    /// nothing, or if what lies behind a goal is seen by no node.
    #[inline(always)]
    pub fn new(target: &Target, nodes: &ProxyPoints) -> Option<Self> {
        let mut faces = Self { numbers: [nodes.surface[0]; MOST_FACES], count: 1 };
        for number in nodes.surface {
            faces.add(number)?;
        }
        if let [side] = *faces.all() {
            faces.add_beside(target.proxy, nodes, side)?;
        }
        for (index, billboard) in target.proxy.billboards.iter().enumerate() {
            let x = billboard.x_m as f32 - target.placement.position_in_world[0];
            match crossing(&Edges::new(billboard), x, &target.placement, nodes) {
                Crossing::None => {}
                Crossing::Some => faces.add((FIRST_BILLBOARD + index) as f32)?,
                Crossing::EdgeOn => return None,
            }
        }
        let is_goal_alone = faces.count == 1 && nodes.surface[0] >= FIRST_BILLBOARD as f32;
        (!is_goal_alone).then_some(faces)
    }

    /// Adds the sides of the box that meet this one within a cell all of whose nodes see it: a corner may lie between the nodes.
    #[inline(always)]
    fn add_beside(&mut self, proxy: &ProxyGeometry, nodes: &ProxyPoints, side: f32) -> Option<()> {
        let side = side as usize;
        if side >= FIRST_BILLBOARD {
            return Some(());
        }
        for axis in 0..3 {
            if axis == side % 3 {
                continue;
            }
            let [least, most] = range(&nodes.place[axis]);
            if least < proxy.min_in_world[axis] as f32 {
                self.add(axis as f32)?;
            }
            if most > proxy.max_in_world[axis] as f32 {
                self.add((axis + 3) as f32)?;
            }
        }
        Some(())
    }

    #[inline(always)]
    fn add(&mut self, number: f32) -> Option<()> {
        if number.is_nan() {
            return None;
        }
        if !self.all().contains(&number) {
            *self.numbers.get_mut(self.count)? = number;
            self.count += 1;
        }
        Some(())
    }

    #[inline(always)]
    pub fn all(&self) -> &[f32] {
        &self.numbers[..self.count]
    }

    /// Returns whether all sixteen pixels see one of the surfaces.
    #[inline(always)]
    pub fn hold(&self, surfaces: &Lanes) -> bool {
        let mut held = 0u32;
        for i in 0..LANES {
            let is_held = self.numbers[0] == surfaces[i]
                || self.numbers[1] == surfaces[i]
                || self.numbers[2] == surfaces[i];
            held += u32::from(is_held);
        }
        held as usize == LANES
    }
}

/// How the edges of a billboard lie in a cell.
enum Crossing {
    None,
    Some,
    /// The billboard's plane is seen edge-on: it ends far away.
    EdgeOn,
}

/// Returns whether an edge of a billboard, `x` metres in front of the camera along the world's x axis, may cross a cell.
#[inline(always)]
fn crossing(edges: &Edges, x: f32, eye: &Placement, nodes: &ProxyPoints) -> Crossing {
    let [_, eye_y, eye_z] = eye.position_in_world;
    let (mut y, mut z) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    let mut towards = 0u32;
    for i in 0..LANES {
        let distance = x / nodes.direction[0][i];
        y[i] = eye_y + distance * nodes.direction[1][i];
        z[i] = eye_z + distance * nodes.direction[2][i];
        towards += u32::from(distance > 0.0);
    }
    match towards as usize {
        0 => Crossing::None,
        LANES if edges.meeting(range(&y), range(&z), [0.0; 2]) == Meeting::Partly => Crossing::Some,
        LANES => Crossing::None,
        _ => Crossing::EdgeOn,
    }
}

/// Returns where rays in these directions, world axes, meet the plane of a surface, beyond its borders too; `None` if one of them does not.
#[inline(always)]
pub(crate) fn on_face(
    proxy: &ProxyGeometry,
    eye: &Placement,
    direction: &[Lanes; 3],
    face: f32,
) -> Option<ProxyPoints> {
    let number = face as usize;
    let (axis, at) = match number {
        0..3 => (number, proxy.min_in_world[number]),
        3..FIRST_BILLBOARD => (number - 3, proxy.max_in_world[number - 3]),
        _ => (0, proxy.billboards[number - FIRST_BILLBOARD].x_m),
    };
    let ahead = at as f32 - eye.position_in_world[axis];
    let (mut distance, mut place) = ([0.0_f32; LANES], [[0.0_f32; LANES]; 3]);
    let mut met = 0u32;
    for i in 0..LANES {
        distance[i] = ahead / direction[axis][i];
        met += u32::from(distance[i] > 0.0 && distance[i] < f32::INFINITY);
    }
    for axis in 0..3 {
        for i in 0..LANES {
            place[axis][i] = eye.position_in_world[axis] + distance[i] * direction[axis][i];
        }
    }
    let on_ground = [if face == GROUND { 1.0 } else { 0.0 }; LANES];
    let points = ProxyPoints { place, direction: *direction, distance, on_ground, surface: [face; LANES] };
    (met as usize == LANES).then_some(points)
}
