//! Writes and reads an output, bit for bit. Of the pings, only those that are newer than the previous output are
//! written.

use mdle_runtime::{
    Compass, Meters, MetersPerSecond, Mount, Nanos, Ping, Pings, Pose, Published, RadiansPerSecond, SONARS, Sensed,
    Supply, Twist, Volts,
};

use crate::Constants;
use crate::bytes::{ByteReader, put_f32, put_f64, put_pose, put_u32, put_u64};

/// Tag for a compass that can be computed from the output and the previous compass.
const COMPUTED: u8 = 0;
/// Tag for a compass without measurements.
const UNUSED: u8 = 1;
/// Tag for any other compass.
const UNKNOWN: u8 = 2;

/// Writes an output, without the pings that the previous output `before` contains.
pub(crate) fn put(y: &Sensed, before: Option<&Sensed>, to: &mut Vec<u8>) {
    put_u64(to, y.at.0);
    put_pose(to, &y.odometry);
    put_twist(y.velocity, to);
    put_u32(to, y.switches);
    put_f64(to, y.supply.battery.0);
    let is_aged = y.data_age != Nanos::ZERO;
    to.push(u8::from(y.supply.is_low) | u8::from(y.supply.is_plugged) << 1 | u8::from(is_aged) << 2);
    if is_aged {
        put_u64(to, y.data_age.0);
    }
    to.push(match y.compass {
        compass if compass == computed(y, before) => COMPUTED,
        compass if compass == Compass::default() => UNUSED,
        _ => UNKNOWN,
    });
    let fresh: [usize; SONARS] =
        std::array::from_fn(|sonar| fresh(y.pings.get(sonar), before.and_then(|before| before.pings.get(sonar))));
    put_u32(to, (0..).zip(fresh).fold(0, |mask, (sonar, count)| mask | (count as u32) << (2 * sonar)));
    for (sonar, (pings, count)) in y.pings.iter().zip(fresh).enumerate() {
        let mut newest = [None; mdle_runtime::PINGS_KEPT];
        newest.iter_mut().zip(pings.newest_first().take(count)).for_each(|(place, ping)| *place = Some(ping));
        let mut mount = last_mount(before.and_then(|before| before.pings.get(sonar)));
        for ping in newest.into_iter().rev().flatten() {
            put_ping(ping, y, mount, to);
            mount = ping.mount;
        }
    }
}

/// Writes a speed and a turn rate.
pub(crate) fn put_twist(twist: Twist, to: &mut Vec<u8>) {
    put_f64(to, twist.v.0);
    put_f64(to, twist.omega.0);
}

pub(crate) fn take_twist(from: &mut ByteReader<'_>) -> Option<Twist> {
    Some(Twist { v: MetersPerSecond(from.f64()?), omega: RadiansPerSecond(from.f64()?) })
}

/// Computes the compass from the output's data and the previous compass.
fn computed(y: &Sensed, before: Option<&Sensed>) -> Compass {
    let mut compass = before.map_or_else(Compass::default, |before| before.compass);
    compass.take(&y.pings, y.odometry, &y.shape);
    compass
}

/// Returns the number of pings that are newer than all pings of the previous output. Pings are compared bit by bit,
/// because a range may be a NaN.
fn fresh(pings: Option<&Pings>, before: Option<&Pings>) -> usize {
    let bits = |pose: &Pose| [pose.x.0, pose.y.0, pose.theta.0].map(f64::to_bits);
    let mount = |mount: Mount| [mount.left, mount.turned].map(f32::to_bits);
    let all = |ping: &Ping| (ping.at, ping.range.map(|range| range.0.to_bits()), bits(&ping.pose), mount(ping.mount));
    let newest = before.and_then(|before| before.newest_first().next()).map(all);
    pings.map_or(0, |pings| pings.newest_first().take_while(|ping| Some(all(ping)) != newest).count())
}

/// Returns the mount of a sonar's newest ping; the next ping usually has the same mount.
fn last_mount(pings: Option<&Pings>) -> Mount {
    pings.and_then(|pings| pings.newest_first().next()).map_or(Mount::default(), |ping| ping.mount)
}

/// Writes a ping; `mount` is the mount of the sonar's previous ping.
fn put_ping(ping: &Ping, y: &Sensed, mount: Mount, to: &mut Vec<u8>) {
    let is_mounted =
        [ping.mount.left, ping.mount.turned].map(f32::to_bits) == [mount.left, mount.turned].map(f32::to_bits);
    let is_here = ping.at == y.at
        && [ping.pose, y.odometry]
            .map(|pose| [pose.x.0, pose.y.0, pose.theta.0].map(f64::to_bits))
            .windows(2)
            .all(|pair| matches!(pair, [one, other] if one == other));
    to.push(u8::from(is_here) | u8::from(ping.range.is_some()) << 1 | u8::from(is_mounted) << 2);
    if let Some(Meters(range)) = ping.range {
        put_f64(to, range);
    }
    if !is_here {
        put_u64(to, ping.at.0);
        put_pose(to, &ping.pose);
    }
    if !is_mounted {
        put_f32(to, ping.mount.left);
        put_f32(to, ping.mount.turned);
    }
}

/// Reads an output that follows the output `before`. Returns `None` if the bytes are not an output, or if the recorded
/// drift of the heading does not follow from the pings.
pub(crate) fn take(from: &mut ByteReader<'_>, before: Option<&Sensed>, constants: &Constants) -> Option<Sensed> {
    let mut y = Sensed {
        at: from.nanos()?,
        data_age: Nanos::ZERO,
        odometry: from.pose()?,
        velocity: take_twist(from)?,
        switches: from.u32()?,
        pings: before.map_or_else(Default::default, |before| before.pings),
        compass: Compass::default(),
        supply: Supply::default(),
        shape: constants.shape,
        paths: constants.paths,
        published: Published::NONE,
    };
    let battery = Volts(from.f64()?);
    let flags = from.u8()?;
    y.supply = Supply { battery, is_low: flags & 1 != 0, is_plugged: flags & 2 != 0 };
    if flags & 4 != 0 {
        y.data_age = from.nanos()?;
    }
    let compass = from.u8()?;
    let mask = from.u32()?;
    for (sonar, pings) in y.pings.iter_mut().enumerate() {
        for _ in 0..(mask >> (2 * sonar)) & 3 {
            let flags = from.u8()?;
            let range = if flags & 2 != 0 { Some(Meters(from.f64()?)) } else { None };
            let (at, pose) = if flags & 1 != 0 { (y.at, y.odometry) } else { (from.nanos()?, from.pose()?) };
            let mount =
                if flags & 4 != 0 { last_mount(Some(pings)) } else { Mount { left: from.f32()?, turned: from.f32()? } };
            pings.push(Ping { range, at, pose, mount });
        }
    }
    match compass {
        COMPUTED => y.compass = computed(&y, before),
        UNUSED => {}
        _ => return None,
    }
    Some(y)
}
