//! Formats of times: RFC 3339 with its zone, and the short form at the beginning of a log line. No function here
//! reads the clock.

use jiff::Timestamp;
use jiff::tz::{Offset, TimeZone};

use hallsweep_core::units::WallTime;

/// The time in RFC 3339 with milliseconds and offset, such as `2026-02-03T10:05:12.000+01:00`.
pub fn rfc3339(wall: WallTime) -> String {
    zoned(wall).strftime("%Y-%m-%dT%H:%M:%S%.3f%:z").to_string()
}

/// The minute, such as `2026-02-03T10:05+01:00`.
pub fn minute(wall: WallTime) -> String {
    zoned(wall).strftime("%Y-%m-%dT%H:%M%:z").to_string()
}

/// The time of day, such as `10:05:12`, in the zone of `wall`.
pub fn clock_time(wall: WallTime) -> String {
    zoned(wall).strftime("%H:%M:%S").to_string()
}

/// Date and time, such as `3 Feb 2026, 10:05:12`, in the zone of `wall`.
pub fn date_and_time(wall: WallTime) -> String {
    zoned(wall).strftime("%-d %b %Y, %H:%M:%S").to_string()
}

/// The beginning of a day such as `2026-01-31`, in the zone of this machine; `None` if `day` is no date.
pub fn midnight(day: &str) -> Option<WallTime> {
    let begins = day.parse::<jiff::civil::Date>().ok()?.to_zoned(TimeZone::system()).ok()?;
    Some(WallTime { unix_ms: begins.timestamp().as_millisecond(), offset_s: begins.offset().seconds() })
}

/// The single zone of a page. The page shows all times in this zone, and names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Zone {
    offset_s: i32,
}

impl Zone {
    pub const fn of(wall: WallTime) -> Zone {
        Zone { offset_s: wall.offset_s }
    }

    /// The name of the zone, such as `UTC+01:00`.
    pub fn name(self) -> String {
        format!("UTC{}", zoned(WallTime { unix_ms: 0, offset_s: self.offset_s }).strftime("%:z"))
    }

    /// Seconds east of Greenwich.
    pub const fn offset_s(self) -> i32 {
        self.offset_s
    }

    /// The time of day in this zone, such as `10:05:12`.
    pub fn clock_time(self, wall: WallTime) -> String {
        clock_time(self.shown(wall))
    }

    /// Date and time in this zone, such as `3 Feb 2026, 10:05:12`.
    pub fn date_and_time(self, wall: WallTime) -> String {
        date_and_time(self.shown(wall))
    }

    const fn shown(self, wall: WallTime) -> WallTime {
        WallTime { offset_s: self.offset_s, ..wall }
    }
}

/// The time in its zone. A time outside the calendar's range becomes the nearest time within the range. An offset
/// outside the range becomes UTC.
fn zoned(wall: WallTime) -> jiff::Zoned {
    let nearest = if wall.unix_ms < 0 { Timestamp::MIN } else { Timestamp::MAX };
    let at = Timestamp::from_millisecond(wall.unix_ms).unwrap_or(nearest);
    let offset = Offset::from_seconds(wall.offset_s).unwrap_or(Offset::UTC);
    at.to_zoned(TimeZone::fixed(offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_carries_its_zone() {
        let wall = WallTime { unix_ms: 1_770_109_512_250, offset_s: 3600 };
        assert_eq!(rfc3339(wall), "2026-02-03T10:05:12.250+01:00");
        assert_eq!(clock_time(wall), "10:05:12");
        assert_eq!(date_and_time(wall), "3 Feb 2026, 10:05:12");
    }

    #[test]
    fn a_page_shows_the_moments_of_every_zone_in_its_own() {
        let zone = Zone::of(WallTime { unix_ms: 0, offset_s: 3600 });
        let elsewhere = WallTime { unix_ms: 1_770_109_512_250, offset_s: -12_600 };
        assert_eq!(zone.name(), "UTC+01:00");
        assert_eq!(
            (zone.clock_time(elsewhere), zone.date_and_time(elsewhere)),
            ("10:05:12".into(), "3 Feb 2026, 10:05:12".into())
        );
    }

    #[test]
    fn utc_and_zones_of_half_hours_are_written_too() {
        assert_eq!(rfc3339(WallTime { unix_ms: 0, offset_s: 0 }), "1970-01-01T00:00:00.000+00:00");
        assert_eq!(rfc3339(WallTime { unix_ms: 0, offset_s: -12_600 }), "1969-12-31T20:30:00.000-03:30");
    }

    #[test]
    fn a_moment_no_calendar_can_show_does_not_end_the_program() {
        for unix_ms in [i64::MIN, i64::MAX] {
            assert!(!rfc3339(WallTime { unix_ms, offset_s: i32::MAX }).is_empty());
        }
    }
}
