//! Report as a self-contained HTML page: a verdict, pictures, maps and tables.

mod course;
mod effects;
mod gap;
mod maps;
mod notes;
mod pictures;
mod text;

use reality_sim_core::sequence::counted;

use self::maps::Subject;
pub use self::text::{escape, table};
use crate::{
    inference::held_out::ChannelGap,
    measurement::quantity::Channel,
    report::data::{Maps, Report},
    report::pictures::Pictures,
    report::text::{channel_title, summary, verdict_word},
};

const STYLE: &str = include_str!("style.css");

/// Returns the whole page in UTF-8, with its pictures embedded.
pub fn page(report: &Report, pictures: &Pictures) -> String {
    let title = escape(&format!("Gap: {}", report.recording));
    let sections = [
        verdict(report),
        pictures::section(pictures, report),
        channels(report),
        gap::section(&report.gap),
        effects::section(report),
        effects::unexplained(&report.unexplained),
        effects::objects(&report.objects),
        notes::section(report),
    ];
    document(&title, &sections.concat())
}

/// Returns a page in UTF-8 in the style of the reports. Title and body are HTML.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )
}

fn verdict(report: &Report) -> String {
    format!(
        "<h1>Simulation against recording: {}</h1>\n<p class=\"verdict\">{}</p>\n<p class=\"quiet\"><span \
         class=\"word\">{}</span> {}, {} of them held out</p>\n",
        escape(&report.recording),
        // A no-break space keeps a percent sign from starting a line.
        escape(&summary(report)).replace(" %", "&#160;%"),
        verdict_word(report.verdict),
        counted(report.frames, "frame"),
        report.held_out_frames
    )
}

/// Returns the drawings of all channels. The channel whose gap was closed most comes first; the others are folded, except
/// those in which an effect closes some of the gap.
fn channels(report: &Report) -> String {
    let Some(first) = most_closed(report) else { return String::new() };
    let others = report.maps.iter().filter(|(channel, _)| **channel != first);
    let folded = others.map(|(&channel, maps)| {
        let name = escape(channel_title(channel));
        let open = if report.effects.iter().any(|effect| effect.closes.contains_key(&channel)) {
            " open"
        } else {
            ""
        };
        format!("<details{open}><summary>{name}</summary>\n{}</details>\n", drawings(report, channel, maps))
    });
    let shown = report.maps.get(&first).map(|maps| drawings(report, first, maps)).unwrap_or_default();
    let title = escape(channel_title(first));
    format!("<h2>Where and when they differ: {title}</h2>\n{shown}{}", folded.collect::<String>())
}

/// Returns the channel whose gap was reduced most, in noise floors; in a tie, the first channel.
fn most_closed(report: &Report) -> Option<Channel> {
    let closed = |channel: &Channel| {
        let size = |gap: &ChannelGap| (gap.before - gap.after) / gap.floor.max(f64::MIN_POSITIVE);
        report
            .gap
            .channels
            .get(channel)
            .map(size)
            .filter(|size| size.is_finite())
            .unwrap_or(f64::NEG_INFINITY)
    };
    let drawn = Channel::ALL.into_iter().rev().filter(|channel| report.maps.contains_key(channel));
    drawn.max_by(|a, b| closed(a).total_cmp(&closed(b)))
}

fn drawings(report: &Report, channel: Channel, maps: &Maps) -> String {
    let floor = report.gap.channels.get(&channel).map(|gap| gap.floor);
    let course = course::drawing(&maps.time, channel, floor);
    // Odometry has no place in the picture or on the field.
    if channel == Channel::Motion {
        return course;
    }
    let subject = Subject { channel, place: "in the picture", field: None };
    let on_field = Subject { place: "on the field", field: Some(&report.field), ..subject };
    format!("{}{}{course}", maps::pair(&maps.picture, subject), maps::pair(&maps.field, on_field))
}

#[cfg(test)]
mod tests;
