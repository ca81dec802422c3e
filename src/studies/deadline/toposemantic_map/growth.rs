//! The growth of the map: Algorithm 1, and the recognition of known vertices, which its listing leaves to the IDS.

use super::{Arrival, Edge, End, MapError, SemanticLabel, ToposemanticMap, Vertex, VertexId};
use crate::geometry::{Axis, Cardinal};
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::{Exit, Intersection, Opening};

impl ToposemanticMap {
    /// Puts the vertex at which the robot begins into the empty map.
    ///
    /// # Errors
    /// A map that is not empty, or an impossible intersection.
    pub fn begin(&mut self, here: &Intersection) -> Result<VertexId, MapError> {
        if let Some(first) = self.vertices.first() {
            return Err(MapError::Begun { label: first.label });
        }
        possible(here)?;
        Ok(self.add(here, None))
    }

    /// Takes in that the robot left `from` by its exit to the `direction` and arrived where the IDS reports: at a new
    /// vertex ([`Self::create_new_node`]) or a known one, by a known or a new edge. A known vertex learns exits that
    /// were not seen before.
    ///
    /// # Errors
    /// The IDS's report does not fit the map, which stays as it was.
    pub fn arrive(
        &mut self,
        from: VertexId,
        direction: Cardinal,
        here: &Intersection,
    ) -> Result<(VertexId, Arrival), MapError> {
        possible(here)?;
        let (_, end) = self.exit(from, direction)?;
        let known = self.recognise(here)?;
        if let End::Vertex(before) = end
            && known != Some(before)
        {
            return Err(MapError::LedElsewhere {
                from: self.label(from),
                direction,
                before: self.label(before),
                now: known.map_or_else(|| NEW.to_owned(), |v| self.label(v).to_string()),
            });
        }
        let Some(vertex) = known else {
            return Ok((self.create_new_node(from, direction, here)?, Arrival::New));
        };
        if self.place(vertex) != here.place {
            let now = place_name(here.place);
            return Err(MapError::OtherPlace { label: self.label(vertex), now });
        }
        let closes = end == End::Unexplored;
        if closes {
            self.may_close(from, direction, vertex, here)?;
        }
        self.learn(vertex, here);
        if closes {
            self.join(from, direction, vertex);
        }
        Ok((vertex, if closes { Arrival::LoopClosed } else { Arrival::Revisit }))
    }

    /// Does `createNewNode(v', edges)`, Algorithm 1; `from` is v, the vertex from which the robot came (line 2).
    /// Comments name the lines of the listing.
    ///
    /// Lines 6 and 7 of the listing set D(v', v) and S(v', v) twice; (v, v') and (v', v) are meant.
    ///
    /// # Errors
    /// No such exit, or an intersection that is not new, has no exit back or another opening there.
    pub fn create_new_node(
        &mut self,
        from: VertexId,
        direction: Cardinal,
        new: &Intersection,
    ) -> Result<VertexId, MapError> {
        possible(new)?;
        if let Some(known) = self.recognise(new)? {
            return Err(MapError::NotNew { label: self.label(known) });
        }
        let (opening, end) = self.exit(from, direction)?;
        if let End::Vertex(before) = end {
            return Err(MapError::LedElsewhere {
                from: self.label(from),
                direction,
                before: self.label(before),
                now: NEW.to_owned(),
            });
        }
        let back = new.exits.iter().find(|exit| exit.direction == direction.opposite());
        self.match_openings(from, direction, opening, NEW, back.map(|exit| exit.opening))?;
        // Lines 3, 5, 8 and 9: V, L(v') and the edges (v', v∅), which carry D and S by their direction.
        let along = (opening == Opening::Corridor).then(|| (self.label(from), direction.axis()));
        let vertex = self.add(new, along);
        // Lines 4, 6 and 7: (v, v') and (v', v).
        self.join(from, direction, vertex);
        Ok(vertex)
    }

    fn exit(&self, v: VertexId, direction: Cardinal) -> Result<(Opening, End), MapError> {
        self.vertices[v.0].exits[direction.index()]
            .ok_or_else(|| MapError::NoSuchExit { label: self.label(v), direction })
    }

    fn add(&mut self, here: &Intersection, along: Option<(SemanticLabel, Axis)>) -> VertexId {
        let mut exits = [None; 4];
        for exit in &here.exits {
            exits[exit.direction.index()] = Some((exit.opening, End::Unexplored));
        }
        self.vertices.push(Vertex {
            label: self.labels.next(here.place, along),
            tags: here.tags.iter().cloned().collect(),
            is_goal: here.is_goal,
            exits,
        });
        VertexId(self.vertices.len() - 1)
    }

    /// Adds to `v` what was not seen of it before.
    fn learn(&mut self, v: VertexId, here: &Intersection) {
        let vertex = &mut self.vertices[v.0];
        for tag in &here.tags {
            if !vertex.tags.contains(tag) {
                vertex.tags.insert(tag.clone());
            }
        }
        vertex.is_goal |= here.is_goal;
        for Exit { direction, opening } in &here.exits {
            vertex.exits[direction.index()].get_or_insert((*opening, End::Unexplored));
        }
    }

    /// Returns whether the unexplored exit of `from` to the `direction` can lead to the known vertex `to`, seen as
    /// `here`, and the exit of `to` back here.
    fn may_close(
        &self,
        from: VertexId,
        direction: Cardinal,
        to: VertexId,
        here: &Intersection,
    ) -> Result<(), MapError> {
        if from == to {
            return Err(MapError::Loop { label: self.label(from), direction });
        }
        let (opening, _) = self.exit(from, direction)?;
        let back = self.edge(to, direction.opposite());
        let seen_now = here.exits.iter().find(|exit| exit.direction == direction.opposite());
        let back_opening = back.map(|edge| edge.opening).or(seen_now.map(|exit| exit.opening));
        self.match_openings(from, direction, opening, &self.label(to).to_string(), back_opening)?;
        if let Some(Edge { to: End::Vertex(other), .. }) = back {
            return Err(MapError::BackElsewhere {
                from: self.label(from),
                direction,
                to: self.label(to),
                other: self.label(other),
            });
        }
        if let Some(first) = self.edges_from(from).find(|edge| edge.to == End::Vertex(to)) {
            return Err(MapError::Parallel {
                from: self.label(from),
                first: first.direction,
                second: direction,
                to: self.label(to),
            });
        }
        Ok(())
    }

    fn match_openings(
        &self,
        from: VertexId,
        direction: Cardinal,
        here: Opening,
        to: &str,
        there: Option<Opening>,
    ) -> Result<(), MapError> {
        let (from, to) = (self.label(from), to.to_owned());
        match there {
            None => Err(MapError::NoWayBack { from, direction, to }),
            Some(there) if there != here => Err(MapError::OtherOpening {
                from,
                direction,
                to,
                here: opening_name(here),
                there: opening_name(there),
            }),
            Some(_) => Ok(()),
        }
    }

    /// Joins two vertices by edges: the only place where these are made, always both, in opposite directions.
    fn join(&mut self, from: VertexId, direction: Cardinal, to: VertexId) {
        for (vertex, direction, end) in [(from, direction, to), (to, direction.opposite(), from)] {
            if let Some((_, unexplored)) = &mut self.vertices[vertex.0].exits[direction.index()] {
                *unexplored = End::Vertex(end);
            }
        }
    }
}

const NEW: &str = "a new vertex";

fn possible(here: &Intersection) -> Result<(), MapError> {
    if here.tags.is_empty() {
        return Err(MapError::NoTags);
    }
    let mut seen = [false; 4];
    for exit in &here.exits {
        if std::mem::replace(&mut seen[exit.direction.index()], true) {
            return Err(MapError::DoubleExit { direction: exit.direction });
        }
    }
    Ok(())
}

const fn opening_name(opening: Opening) -> &'static str {
    match opening {
        Opening::Corridor => "corridor",
        Opening::Door => "door",
    }
}

const fn place_name(place: Place) -> &'static str {
    match place {
        Place::Room => "room",
        Place::Corridor => "corridor",
    }
}
