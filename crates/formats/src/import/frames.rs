//! Frames of a robot and the transforms between them, over time: from `tf` topics, and from a URDF with joints.

use std::collections::HashMap;

use super::{
    clock::Clock,
    series::{Sample, Series},
    urdf::UrdfJoint,
};
use crate::message::Rigid;

/// Most frames on the way from one to the root: those of robots are a dozen deep.
const MAX_DEPTH: usize = 100;

/// Tree of frames.
#[derive(Debug, Default)]
pub struct FrameTree {
    /// Ways to the parents, by the children's names.
    edges: HashMap<String, Edge>,
    joints: HashMap<String, Series<f64>>,
}

#[derive(Debug)]
struct Edge {
    parent: String,
    kind: EdgeKind,
}

#[derive(Debug)]
enum EdgeKind {
    Fixed(Rigid),
    Moving(Series<Rigid>),
    Joint(Box<UrdfJoint>),
}

impl FrameTree {
    /// Adds a transform that holds always.
    pub fn add_fixed(&mut self, parent: &str, child: &str, parent_from_child: Rigid) {
        let edge = Edge { parent: parent.to_owned(), kind: EdgeKind::Fixed(parent_from_child) };
        self.edges.insert(child.to_owned(), edge);
    }

    /// Adds a transform that holds at a time.
    pub fn add_moving(&mut self, parent: &str, child: &str, sample: Sample<Rigid>) {
        match self.edges.get_mut(child) {
            Some(Edge { parent: known, kind: EdgeKind::Moving(series) }) if known == parent => {
                series.push(sample);
            }
            // A frame has one parent; the first that is heard of is kept.
            Some(_) => {}
            None => {
                let mut series = Series::default();
                series.push(sample);
                let edge = Edge { parent: parent.to_owned(), kind: EdgeKind::Moving(series) };
                self.edges.insert(child.to_owned(), edge);
            }
        }
    }

    /// Adds what a joint measured.
    pub fn add_joint_position(&mut self, name: &str, sample: Sample<f64>) {
        match self.joints.get_mut(name) {
            Some(series) => series.push(sample),
            None => {
                let mut series = Series::default();
                series.push(sample);
                self.joints.insert(name.to_owned(), series);
            }
        }
    }

    /// Adds the joints of a robot's description where no `tf` tells the transform; returns whether there were any.
    pub fn add_urdf(&mut self, joints: Vec<UrdfJoint>) -> bool {
        let mut is_new = false;
        for joint in joints {
            let (child, parent) = (joint.child.clone(), joint.parent.clone());
            self.edges.entry(child).or_insert_with(|| {
                is_new = true;
                Edge { parent, kind: EdgeKind::Joint(Box::new(joint)) }
            });
        }
        is_new
    }

    /// Puts all series in order of time.
    pub fn finish(&mut self, clock: &Clock) {
        for edge in self.edges.values_mut() {
            if let EdgeKind::Moving(series) = &mut edge.kind {
                series.finish(clock);
            }
        }
        self.joints.values_mut().for_each(|series| series.finish(clock));
    }

    /// Returns the frame and those above it, up to the root; just the frame if it is not known.
    pub fn chain<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let mut chain = vec![frame];
        while let Some(edge) = self.edges.get(chain[chain.len() - 1]) {
            if chain.len() > MAX_DEPTH || chain.contains(&edge.parent.as_str()) {
                break;
            }
            chain.push(&edge.parent);
        }
        chain
    }

    /// Returns whether there is a way from one frame to another.
    pub fn connects(&self, a: &str, b: &str) -> bool {
        let above = self.chain(a);
        self.chain(b).iter().any(|frame| above.contains(frame))
    }

    /// Returns whether the way from one frame to another passes joints of a robot's description.
    pub fn passes_joints(&self, a: &str, b: &str) -> bool {
        let is_joint =
            |frame: &&str| matches!(self.edges.get(*frame), Some(Edge { kind: EdgeKind::Joint(_), .. }));
        let (a, b) = (self.chain(a), self.chain(b));
        let apart = |from: &[&str], other: &[&str]| {
            from.iter().take_while(|frame| !other.contains(frame)).any(is_joint)
        };
        apart(&a, &b) || apart(&b, &a)
    }

    /// Returns the transform `a_from_b` at a time; `None` where the frames have nothing in common or nothing is known of a
    /// transform between them at that time.
    pub fn transform(&self, a: &str, b: &str, time_ns: i64, tolerance_ns: i64) -> Option<Rigid> {
        let (above_a, above_b) = (self.chain(a), self.chain(b));
        let common = above_a.iter().find(|frame| above_b.contains(frame))?;
        let common_from = |chain: &[&str]| {
            let steps = chain.iter().take_while(|frame| *frame != common);
            steps.copied().try_fold(Rigid::IDENTITY, |below, frame| {
                Some(self.edge(frame, time_ns, tolerance_ns)?.then(below))
            })
        };
        let (from_a, from_b) = (common_from(&above_a)?, common_from(&above_b)?);
        Some(if from_a == Rigid::IDENTITY { from_b } else { from_a.inverse().then(from_b) })
    }

    /// Returns `parent_from_child` at a time.
    fn edge(&self, child: &str, time_ns: i64, tolerance_ns: i64) -> Option<Rigid> {
        match &self.edges.get(child)?.kind {
            EdgeKind::Fixed(transform) => Some(*transform),
            // One that was sent once holds always.
            EdgeKind::Moving(series) => match series.samples() {
                [only] => Some(only.value),
                _ => series.at(time_ns, tolerance_ns),
            },
            EdgeKind::Joint(joint) => {
                let position = |name: &str| self.joints.get(name)?.at(time_ns, tolerance_ns);
                joint.transform(position)
            }
        }
    }
}
