//! HTML of the page.

use crate::chart::{Chart, svg};
use crate::facts::Fact;
use crate::html::{escaped, folded};
use crate::playback::Playback;
use files::REPORT_START;

/// Contents of the page.
pub(super) struct Page<'a> {
    pub(super) title: &'a str,
    pub(super) facts: &'a [Fact],
    /// The answers of the run as HTML.
    pub(super) answers: &'a str,
    pub(super) warnings: &'a [String],
    /// The frames to play, and the axis that is drawn upwards.
    pub(super) playback: Option<(&'a Playback, char)>,
    pub(super) charts: &'a [Chart],
    /// Tables as HTML.
    pub(super) tables: &'a str,
    pub(super) plan: &'a str,
    pub(super) scene: &'a str,
}

const STYLE: &str = include_str!("../assets/page.css");
const PLAYER: &str = include_str!("../assets/player.js");

/// HTML of the player.
const STAGE: &str = r#"<section id="player">
<div id="picture"></div>
<div id="controls">
<button id="play" type="button">Play</button>
<input id="frame" type="range" min="0" value="0" step="1" aria-label="frame">
<label>colours: <select id="colouring"></select></label>
<button id="reset" type="button">Reset view</button>
{CHOICE}</div>
<p><span id="time"></span> <span id="legend"></span></p>
</section>
"#;
/// HTML of the checkbox that shrinks the spheres, so that the lines between their centres are visible.
const CHAINS: &str = "<label><input id=\"show-chains\" type=\"checkbox\"> contact forces</label>\n";
const AXES: &str = "<label><input id=\"show-axes\" type=\"checkbox\"> axes</label>\n";
const HINT: &str = "Drag to turn, with the right button to move, wheel to zoom; space plays, arrows step.";

impl Page<'_> {
    /// The page as HTML: a single file that needs no other.
    pub(super) fn html(&self) -> String {
        let title = escaped(self.title);
        let played = self.playback.filter(|(playback, _)| playback.shown() > 0);
        let [stage, script] = [played.map(|_| self.stage()), played.map(|(playback, up)| script(playback, up))]
            .map(Option::unwrap_or_default);
        let charts: String = self.charts.iter().filter_map(figure).collect();
        format!(
            "{}<meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
             <link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
             {}{}{}{stage}\
             <div class=\"charts\">\n{charts}</div>\n{}{}{}{script}</body>\n</html>\n",
            REPORT_START,
            self.warned(),
            self.told(),
            self.answers,
            self.tables,
            folded("How it was computed", &preformatted(self.plan)),
            folded("The scene", &preformatted(self.scene)),
        )
    }

    fn told(&self) -> String {
        let fact = |(name, what): &Fact| format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escaped(what));
        format!("<dl>\n{}</dl>\n", self.facts.iter().map(fact).collect::<String>())
    }

    fn warned(&self) -> String {
        let item = |warning: &String| format!("<li>{}</li>\n", escaped(warning));
        let items = self.warnings.iter().map(item).collect::<String>();
        if items.is_empty() { items } else { format!("<ul class=\"warnings\">\n{items}</ul>\n") }
    }

    fn stage(&self) -> String {
        let counts = self.playback.map(|(playback, _)| (playback.shown(), playback.recorded));
        let part = counts.filter(|(shown, recorded)| shown < recorded).map_or_else(String::new, |(shown, recorded)| {
            format!(
                "Of the {recorded} frames of the trajectory this page has {shown}, equally spaced, so that it stays \
                small. "
            )
        });
        let has_chains = self.playback.is_some_and(|(playback, _)| playback.has_chains());
        let has_axes = self.playback.is_some_and(|(playback, _)| playback.has_axes());
        let choices =
            [(has_axes, AXES), (has_chains, CHAINS)].map(|(is_there, choice)| if is_there { choice } else { "" });
        let stage = STAGE.replace("{CHOICE}", &choices.concat());
        format!("{stage}<p class=\"hint\">{part}{HINT}</p>\n")
    }
}

/// Script of the player, and its data.
fn script(playback: &Playback, up: char) -> String {
    let (description, lists) = playback.parts(up);
    // Text embedded in the page must not look like the end of its element.
    let description = description.to_string().replace('<', "\\u003c");
    let mut script = format!("<script type=\"application/json\" id=\"run\">{description}</script>\n");
    for (id, bytes) in &lists {
        for part in ["<script type=\"text/plain\" id=\"", id, "\">", bytes, "</script>\n"] {
            script += part;
        }
    }
    script + "<script>\n" + PLAYER + "</script>\n"
}

fn figure(chart: &Chart) -> Option<String> {
    Some(format!("<figure><figcaption>{}</figcaption>\n{}</figure>\n", escaped(&chart.title), svg(chart)?))
}

fn preformatted(text: &str) -> String {
    format!("<pre>{}</pre>\n", escaped(text))
}
