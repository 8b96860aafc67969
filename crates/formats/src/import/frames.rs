//! Frames of a robot and the transforms between them, over time: from `tf` topics, and from a URDF with joints.

use std::collections::{HashMap, HashSet};

use super::{
    clock::Clock,
    series::{Sample, Series},
    urdf::UrdfJoint,
};
use crate::message::Rigid;

/// Most frames on the way from one to the root: those of robots are a dozen deep.
const MAX_DEPTH: usize = 100;

/// Number of transforms beyond which only those that are needed are kept: some 50 MB.
const MANY_TRANSFORMS: usize = 500_000;

/// Tree of frames.
#[derive(Debug, Default)]
pub struct FrameTree {
    /// Ways to the parents, by the children's names.
    edges: HashMap<String, Edge>,
    joints: HashMap<String, Series<f64>>,
    /// Number of transforms of moving frames that are kept.
    kept: usize,
    /// Frames whose transforms are still kept, once there are many.
    wanted: Option<HashSet<String>>,
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

    /// Returns whether so many transforms are kept that those of other frames than the needed ones should go.
    pub fn is_large(&self) -> bool {
        self.wanted.is_none() && self.kept > MANY_TRANSFORMS
    }

    /// Forgets the moving frames that are not between these and the root: robots send the transforms of every finger.
    pub fn keep_between(&mut self, frames: &[&str]) {
        let wanted: HashSet<String> =
            frames.iter().flat_map(|frame| self.chain(frame)).map(str::to_owned).collect();
        self.edges.retain(|child, edge| wanted.contains(child) || !matches!(edge.kind, EdgeKind::Moving(_)));
        self.wanted = Some(wanted);
    }

    /// Adds a transform that holds at a time.
    pub fn add_moving(&mut self, parent: &str, child: &str, sample: Sample<Rigid>) {
        if self.wanted.as_ref().is_some_and(|wanted| !wanted.contains(child)) {
            return;
        }
        self.kept += 1;
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
        self.passes(a, b, |kind| matches!(kind, EdgeKind::Joint(_)))
    }

    /// Returns whether a transform on the way from one frame to another changes with time.
    pub fn moves(&self, a: &str, b: &str) -> bool {
        let changes =
            |series: &Series<Rigid>| series.samples().windows(2).any(|pair| pair[0].value != pair[1].value);
        self.passes(a, b, |kind| match kind {
            EdgeKind::Fixed(_) => false,
            EdgeKind::Moving(series) => changes(series),
            EdgeKind::Joint(_) => true,
        })
    }

    /// Returns whether any transform on the way from one frame to another is of a kind.
    fn passes(&self, a: &str, b: &str, is_one: impl Fn(&EdgeKind) -> bool) -> bool {
        let (a, b) = (self.chain(a), self.chain(b));
        let apart = |from: &[&str], other: &[&str]| {
            let own = from.iter().take_while(|frame| !other.contains(frame));
            own.filter_map(|frame| self.edges.get(*frame)).any(|edge| is_one(&edge.kind))
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

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;

    fn sample(x: f64) -> Sample<Rigid> {
        Sample { time_ns: 1, log_time_ns: 1, value: Rigid::new(DQuat::IDENTITY, DVec3::X * x) }
    }

    #[test]
    fn a_frame_that_is_not_on_the_way_is_forgotten_and_the_way_is_kept() {
        let mut tree = FrameTree::default();
        for (parent, child, x) in [("base", "head", 1.0), ("head", "camera", 2.0), ("base", "hand", 3.0)] {
            tree.add_moving(parent, child, sample(x));
        }
        tree.keep_between(&["camera"]);
        tree.add_moving("base", "hand", sample(3.0));
        assert!(!tree.connects("hand", "camera"));
        let way = tree.transform("base", "camera", 1, 0).expect("it is kept");
        assert_eq!(way.translation, DVec3::X * 3.0);
    }

    #[test]
    fn frames_that_are_each_other_s_parents_are_no_endless_loop() {
        let mut tree = FrameTree::default();
        tree.add_moving("a", "b", sample(1.0));
        tree.add_moving("b", "a", sample(1.0));
        assert!(tree.chain("a").len() <= 3);
        assert!(tree.transform("a", "nowhere", 1, 0).is_none());
    }
}
