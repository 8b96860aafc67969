//! Joints of a robot's description (URDF), for forward kinematics. <https://wiki.ros.org/urdf/XML/joint>

use glam::{DQuat, DVec3, EulerRot};
use roxmltree::{Document, Node};

use crate::message::Rigid;

/// Largest description that is read, bytes.
const MAX_BYTES: usize = 8 << 20;

/// Joint between two frames.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfJoint {
    /// Frame before the joint.
    pub parent: String,
    /// Frame behind it.
    pub child: String,
    name: String,
    /// Pose of the child at position 0.
    origin: Rigid,
    motion: Motion,
    /// Joint whose position it follows, with factor and offset.
    follows: Option<(String, f64, f64)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    None,
    Turn(DVec3),
    Slide(DVec3),
}

impl UrdfJoint {
    /// Returns `parent_from_child`, by the positions of joints; `None` if the joint's is not known.
    pub fn transform(&self, position: impl Fn(&str) -> Option<f64>) -> Option<Rigid> {
        let position = || match &self.follows {
            Some((name, factor, offset)) => position(name).map(|position| factor * position + offset),
            None => position(&self.name),
        };
        let moved = match self.motion {
            Motion::None => Rigid::IDENTITY,
            Motion::Turn(axis) => Rigid::new(DQuat::from_axis_angle(axis, position()?), DVec3::ZERO),
            Motion::Slide(axis) => Rigid::new(DQuat::IDENTITY, axis * position()?),
        };
        Some(self.origin.then(moved))
    }
}

/// Reads the joints of a description; `None` if it is not one.
pub fn joints(text: &str) -> Option<Vec<UrdfJoint>> {
    if text.len() > MAX_BYTES {
        return None;
    }
    let document = Document::parse(text).ok()?;
    let robot = document.root_element();
    let is_joint = |node: &Node<'_, '_>| node.has_tag_name("joint");
    (robot.has_tag_name("robot"))
        .then(|| robot.children().filter(is_joint).filter_map(|node| joint(&node)).collect())
}

fn joint(node: &Node<'_, '_>) -> Option<UrdfJoint> {
    let child = |name: &str| node.children().find(|child| child.has_tag_name(name));
    let link =
        |name: &str| child(name)?.attribute("link").map(|link| link.trim_start_matches('/').to_owned());
    let triple = |of: &str, attribute: &str| child(of)?.attribute(attribute).and_then(vector);
    let [roll, pitch, yaw] = triple("origin", "rpy").unwrap_or(DVec3::ZERO).to_array();
    // Fixed axes x, y, z: turns about z, y, x of the moved frame.
    let rotation = DQuat::from_euler(EulerRot::ZYX, yaw, pitch, roll);
    let axis = triple("axis", "xyz").unwrap_or(DVec3::X).try_normalize();
    let motion = match (node.attribute("type")?, axis) {
        ("fixed", _) => Motion::None,
        ("revolute" | "continuous", Some(axis)) => Motion::Turn(axis),
        ("prismatic", Some(axis)) => Motion::Slide(axis),
        _ => return None,
    };
    let follows = child("mimic").and_then(|mimic| {
        let number = |name: &str| mimic.attribute(name).and_then(|text| text.trim().parse().ok());
        Some((
            mimic.attribute("joint")?.to_owned(),
            number("multiplier").unwrap_or(1.0),
            number("offset").unwrap_or(0.0),
        ))
    });
    Some(UrdfJoint {
        parent: link("parent")?,
        child: link("child")?,
        name: node.attribute("name")?.to_owned(),
        origin: Rigid::new(rotation, triple("origin", "xyz").unwrap_or(DVec3::ZERO)),
        motion,
        follows,
    })
}

fn vector(text: &str) -> Option<DVec3> {
    let mut numbers =
        text.split_whitespace().map(|number| number.parse::<f64>().ok().filter(|number| number.is_finite()));
    Some(DVec3::new(numbers.next()??, numbers.next()??, numbers.next()??))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn a_head_that_turns_takes_the_camera_with_it() {
        let text = r#"<?xml version="1.0"?><robot name="r">
            <joint name="neck" type="revolute"><parent link="torso"/><child link="head"/>
              <origin xyz="0 0 0.3" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>
            <joint name="mount" type="fixed"><parent link="head"/><child link="camera"/><origin xyz="0.1 0 0.05"/></joint>
            </robot>"#;
        let joints = joints(text).unwrap();
        let at = |name: &str| (name == "neck").then_some(FRAC_PI_2);
        let torso_from_camera = joints[0].transform(at).unwrap().then(joints[1].transform(at).unwrap());
        assert!((torso_from_camera.translation - DVec3::new(0.0, 0.1, 0.35)).length() < 1e-12);
        assert!(joints[0].transform(|_| None).is_none());
    }
}
