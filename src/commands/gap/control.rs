//! What `gap --inject` hides.

/// What is hidden in the recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Control {
    /// One effect with this size.
    One(String, f64),
    /// Every effect, from its detection limit on until it is named.
    All,
}

impl Control {
    /// Reads `ID=SIZE`, or `all`.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        let (id, size) =
            text.split_once('=').ok_or("give an effect and its size, such as vignetting=0.3, or all")?;
        let id = effect_id(id)?;
        let size: f64 = size.parse().map_err(|_| format!("{size} is no number"))?;
        Ok(Self::One(id, size))
    }
}

/// Reads the id of an effect of the library.
pub(super) fn effect_id(text: &str) -> Result<String, String> {
    if reality_sim::sensor::effect(text).is_some() {
        return Ok(text.to_owned());
    }
    let ids: Vec<_> = reality_sim::sensor::library().iter().map(|effect| effect.id()).collect();
    Err(format!("there is no such effect: give one of {}", ids.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_control_is_an_effect_with_its_size_or_all_of_them() {
        assert_eq!(Control::parse("all"), Ok(Control::All));
        assert_eq!(Control::parse("vignetting=0.3"), Ok(Control::One("vignetting".to_owned(), 0.3)));
        for text in ["", "vignetting", "vignetting=", "vignetting=much", "gremlins=1"] {
            assert!(Control::parse(text).is_err(), "{text}");
        }
    }
}
