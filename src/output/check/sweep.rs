//! A sweep, point by point.

use super::cross_check::CrossCheck;
use super::run::{contradiction, scheme};
use super::stored::StoredRun;
use super::{Checked, Content, SweptPoint, refused};
use crate::error::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::scene::MOST_POINTS;
use crate::surface::SamplingScheme;
use crate::validation::{JointTest, overall};

pub(super) fn check(reader: &Reader) -> Result<Checked, OutputError> {
    let shape = reader.point_shape()?;
    let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length));
    let Some(count) = count.filter(|count| (1..=MOST_POINTS).contains(count)) else {
        let problem = format!("has points of the shape {shape:?}; up to {MOST_POINTS} are read");
        return Err(refused(reader.path(), &problem));
    };
    let scheme = scheme(reader)?;
    // Of the integral alone nothing is tested.
    let has_replicas = reader.number::<u64>("/", "replicas")? > 0;
    let stored = if has_replicas { reader.texts("/validation/verdict")? } else { Vec::new() };
    let (mut points, mut contradictions) = (Vec::with_capacity(count), Vec::new());
    for point in 0..count {
        let place = place(point, &shape);
        let joint = if has_replicas { joint_test(reader, scheme, &place)? } else { None };
        if let Some(joint) = joint {
            let stored = stored.get(point).map_or("", String::as_str);
            let own = contradiction("verdict", stored, joint.verdict);
            contradictions.extend(own.map(|own| format!("point {}: {own}", point + 1)));
        }
        points.push(SweptPoint { place, joint });
    }
    let p_value = |point: &SweptPoint| point.joint.map_or(f64::NAN, |joint| joint.p_value);
    let verdict = overall(&points.iter().map(p_value).collect::<Vec<f64>>());
    if has_replicas {
        let stored = reader.optional_text("/validation", "overall_verdict")?.unwrap_or_default();
        contradictions.extend(contradiction("overall_verdict", &stored, verdict));
    }
    let keys = reader.optional_text("/", "sweep_keys")?.unwrap_or_default();
    Ok(Checked { content: Content::Sweep { keys, points }, verdict, contradictions })
}

/// The index of a point along each dimension of a shape.
fn place(point: usize, shape: &[usize]) -> Vec<usize> {
    let mut rest = point;
    let mut place: Vec<usize> = shape.iter().rev().map(|length| (rest % length, rest /= length).0).collect();
    place.reverse();
    place
}

/// The test of a point; none where a sweep is not complete and the point has no replicas.
fn joint_test(
    reader: &Reader,
    scheme: SamplingScheme,
    place: &[usize],
) -> Result<Option<JointTest>, OutputError> {
    let replicas: u64 = reader.at_point("/replica_count", place)?[0];
    let group = scheme.group();
    if replicas == 0 && reader.has_attribute("/", "partial")? {
        return Ok(None);
    }
    let most = reader.length(Dimension::Replica)? as u64;
    if replicas == 0 || !replicas.is_multiple_of(group) || replicas > most {
        let problem = format!("has {replicas} replicas at a point, no number of {} ones", scheme.name());
        return Err(refused(reader.path(), &problem));
    }
    CrossCheck::new(&StoredRun { reader, place: Some(place), replicas, group }).map(|own| Some(own.joint))
}
