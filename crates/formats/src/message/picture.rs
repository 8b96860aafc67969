//! Pictures, as pixels or as files.

use std::borrow::Cow;

use super::{Header, RawPicture};
use crate::schema::View;

/// First bytes of JPEG and PNG files.
const JPEG: [u8; 3] = [0xff, 0xd8, 0xff];
const PNG: [u8; 4] = [0x89, b'P', b'N', b'G'];

/// Picture of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture<'a> {
    /// Time and frame of the camera.
    pub header: Header,
    /// What it shows.
    pub content: PictureContent<'a>,
}

/// Picture as a message holds it.
#[derive(Debug, Clone, PartialEq)]
pub enum PictureContent<'a> {
    /// JPEG file.
    Jpeg(Cow<'a, [u8]>),
    /// PNG file.
    Png(Cow<'a, [u8]>),
    /// Pixels.
    Raw(RawPicture<'a>),
    /// File in another format, which the message names.
    Other(String),
}

impl<'a> Picture<'a> {
    /// Reads a message with a picture; `None` if it is damaged.
    pub fn read(message: &View<'a>) -> Option<Self> {
        let header = Header::of(message);
        let data = message.field("data")?.bytes()?;
        let content = match message.field("format") {
            Some(_) if data.starts_with(&JPEG) => PictureContent::Jpeg(data),
            Some(_) if data.starts_with(&PNG) => PictureContent::Png(data),
            Some(format) => PictureContent::Other(format.text().unwrap_or_default().into_owned()),
            None => PictureContent::Raw(RawPicture::read(message, data)?),
        };
        Some(Self { header, content })
    }
}
