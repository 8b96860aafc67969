//! Rigid transforms, as messages hold them.

use glam::{DQuat, DVec3};

use crate::schema::View;

/// Largest difference of a quaternion's length from 1 that is rounding or carelessness, not damage.
const LENGTH_TOLERANCE: f64 = 0.1;

/// Rigid transform `a_from_b`: takes coordinates in b, metres, and gives those in a; also the pose of b in a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Rotation.
    pub rotation: DQuat,
    /// Translation, metres.
    pub translation: DVec3,
}

impl Rigid {
    /// Transform that changes nothing.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// Makes a transform.
    pub fn new(rotation: DQuat, translation: DVec3) -> Self {
        Self { rotation, translation }
    }

    /// Returns `a_from_c` of `a_from_b` and `b_from_c`.
    pub fn then(self, b_from_c: Self) -> Self {
        Self {
            rotation: (self.rotation * b_from_c.rotation).normalize(),
            translation: self.translation + self.rotation * b_from_c.translation,
        }
    }

    /// Returns `b_from_a` of `a_from_b`.
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Reads a pose (`position`, `orientation`) or a transform (`translation`, `rotation`).
    pub fn read(view: &View<'_>) -> Option<Self> {
        let translation = vector(&view.any_field(&["position", "translation"])?)?;
        let rotation = quaternion(&view.any_field(&["orientation", "rotation"])?)?;
        Some(Self { rotation, translation })
    }
}

/// Reads a vector of finite numbers.
pub fn vector(view: &View<'_>) -> Option<DVec3> {
    let [x, y, z] = ["x", "y", "z"].map(|name| view.field(name)?.number());
    Some(DVec3::new(x?, y?, z?)).filter(|vector| vector.is_finite())
}

/// Reads a rotation; `None` if the quaternion is zero or not one of length 1.
pub fn quaternion(view: &View<'_>) -> Option<DQuat> {
    let [x, y, z, w] = ["x", "y", "z", "w"].map(|name| view.field(name)?.number());
    let quaternion = DQuat::from_xyzw(x?, y?, z?, w?);
    let length = quaternion.length();
    ((length - 1.0).abs() < LENGTH_TOLERANCE).then(|| quaternion / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_and_its_inverse_change_nothing() {
        let turned = Rigid::new(DQuat::from_rotation_y(0.3), DVec3::new(1.0, 2.0, 3.0));
        let nothing = turned.then(turned.inverse());
        assert!(
            nothing.translation.length() < 1e-12 && (nothing.rotation * DVec3::X - DVec3::X).length() < 1e-12
        );
    }
}
