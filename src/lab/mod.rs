//! The core of the program for the page "Will my pad stick?", which runs it in a browser: text and bytes in and out.
//!
//! A call has a name, an argument and a reply, JSON unless [`Lab::call`] says otherwise. Numbers keep all their bits. One
//! instance makes the laws of a scene and computes replicas; another merges them in order, and has the results that the
//! program would have. `scripts/lab.sh` builds the module of WebAssembly.

#[cfg(target_family = "wasm")]
mod abi;
mod failure;
mod files;
mod map;
mod report;
mod scenes;
mod session;

use self::failure::Failure;
use self::scenes::Text;
use self::session::{Asked, Sent, Session};
use crate::asperity::PlasticContact;
use crate::experiment::Workers;
use crate::scene::units::{Dimension, parse};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// What is asked of results.
#[derive(Default, Deserialize)]
struct ResultsAsked {
    /// The restoring force in the place of the scene's.
    #[serde(default)]
    above: Option<String>,
}

/// The program as a page calls it: one scene at a time.
pub struct Lab {
    workers: Workers,
    session: Option<Session>,
}

impl Lab {
    /// Begins without a scene, on a number of threads; in a browser on the caller's.
    ///
    /// # Errors
    /// [`Error::Threads`](crate::Error::Threads).
    pub fn new(threads: usize) -> Result<Self, crate::Error> {
        Ok(Self { workers: Workers::new(threads, Arc::default())?, session: None })
    }

    /// The reply to a call, by its name. `merge` takes the bytes that `compute` has replied: the length of a head, four bytes,
    /// little-endian; the head, JSON; and the replicas. All else is text.
    pub fn call(&mut self, name: &str, argument: &[u8]) -> Vec<u8> {
        let reply = match name {
            "compute" => text(argument).and_then(|text| self.compute(text)),
            "merge" => self.merge(argument).map(|reply| reply.to_string().into_bytes()),
            _ => text(argument)
                .and_then(|text| self.text(name, text))
                .map(|reply| reply.to_string().into_bytes()),
        };
        reply.unwrap_or_else(|failure| failure.reply().to_string().into_bytes())
    }

    fn text(&mut self, name: &str, argument: &str) -> Result<Value, Failure> {
        match name {
            "version" => Ok(json!({
                "version": env!("CARGO_PKG_VERSION"), "source": env!("STICTION_SOURCE_HASH"),
            })),
            "materials" => Ok(scenes::materials()),
            "template" => scenes::template(argument),
            "edit" => scenes::edit(argument),
            "describe" => scenes::describe(argument),
            "map" => map::map(argument),
            "prepare" => self.prepare(argument),
            "integral" => self.integral(),
            "results" => self.results(argument),
            _ => Err(Failure::new(format!("there is no call {name:?}"))),
        }
    }

    fn session(&mut self) -> Result<(&mut Session, &Workers), Failure> {
        let session = self.session.as_mut().ok_or_else(|| Failure::new("no scene is prepared"))?;
        Ok((session, &self.workers))
    }

    fn prepare(&mut self, argument: &str) -> Result<Value, Failure> {
        self.session = None;
        let session = Session::new(Text::read(argument)?)?;
        let scene = &session.scene;
        let reply = json!({
            "replicas": scene.replicas, "group": scene.sampling.group(), "separations": scene.separations,
            "preloads": scene.instability.preload,
        });
        self.session = Some(session);
        Ok(reply)
    }

    fn integral(&mut self) -> Result<Value, Failure> {
        let (session, workers) = self.session()?;
        let mut reply = report::integral(session.prepared(workers)?);
        reply["parts"] = parts(session);
        Ok(reply)
    }

    fn compute(&mut self, argument: &str) -> Result<Vec<u8>, Failure> {
        let asked: Asked = serde_json::from_str(argument)?;
        let (session, workers) = self.session()?;
        let sent = session.compute(asked, workers)?;
        let head = sent.head(session).to_string().into_bytes();
        let bytes = [&(head.len() as u32).to_le_bytes()[..], &head].concat();
        Ok(postcard::to_extend(&sent, bytes).expect("lists know their lengths"))
    }

    fn merge(&mut self, argument: &[u8]) -> Result<Value, Failure> {
        let damaged = || Failure::new("the piece is damaged, or of another version");
        let (length, rest) = argument.split_first_chunk::<4>().ok_or_else(damaged)?;
        let own = rest.get(u32::from_le_bytes(*length) as usize..).ok_or_else(damaged)?;
        let sent: Sent = postcard::from_bytes(own).map_err(|_| damaged())?;
        let (session, workers) = self.session()?;
        session.merge(sent, workers)?;
        let merged = session.run.tree.as_ref().map_or(0, |tree| tree.replicas.len());
        let range = session.range.iter().filter(|part| part.is_complete).filter_map(|part| part.contact);
        let range: Vec<&str> = range.map(PlasticContact::name).collect();
        Ok(json!({
            "merged": merged, "of": session.run.replicas, "complete": session.run.is_complete, "contacts": range,
            "parts": parts(session),
        }))
    }

    fn results(&mut self, argument: &str) -> Result<Value, Failure> {
        let asked: ResultsAsked = match argument.trim() {
            "" => ResultsAsked::default(),
            text => serde_json::from_str(text)?,
        };
        let force = |text: String| {
            let refused =
                |_| Failure::new(format!("--above {text}: a force with a unit is needed, such as \"1 uN\""));
            parse(&text, Dimension::Force).map_err(refused)
        };
        let above = asked.above.map(force).transpose()?;
        let (session, workers) = self.session()?;
        report::results(session, above, workers)
    }
}

/// The text of an argument.
fn text(argument: &[u8]) -> Result<&str, Failure> {
    std::str::from_utf8(argument).map_err(|_| Failure::new("the call is not UTF-8"))
}

/// The parts that there are to compute.
fn parts(session: &Session) -> Value {
    let name = |contact: Option<PlasticContact>| contact.map(PlasticContact::name);
    let parts = session.parts().into_iter();
    parts.map(|(contact, replicas)| json!({ "contact": name(contact), "replicas": replicas })).collect()
}
