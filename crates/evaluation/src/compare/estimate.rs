//! Means with their 95 % confidence intervals.

use std::fmt;

/// A mean with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    /// Half the width of the interval. 0 if there is only one number, because there is no interval then.
    pub half_width: f64,
    pub count: usize,
}

impl Estimate {
    /// The mean of these numbers with Student's confidence interval. `None` if there are no numbers.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "nobody walks through 2^53 halls")]
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Option<Estimate> {
        let numbers: Vec<f64> = numbers.into_iter().collect();
        let count = numbers.len();
        if count == 0 {
            return None;
        }
        let n = count as f64;
        let mean = numbers.iter().sum::<f64>() / n;
        if count == 1 {
            return Some(Estimate { mean, half_width: 0.0, count });
        }
        let variance = numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Some(Estimate { mean, half_width: student(count - 1) * (variance / n).sqrt(), count })
    }
}

/// Shows the mean, and the interval if there is one. Both have three decimals if the mean is between −100 and
/// 100, and otherwise no decimals.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = |number: f64| if number.abs() < 100.0 { 3 } else { 0 };
        let Estimate { mean, half_width, count } = *self;
        write!(f, "{mean:.*}", digits(mean))?;
        if count > 1 { write!(f, " ± {half_width:.*}", digits(mean)) } else { Ok(()) }
    }
}

/// Student's 97.5 % quantile for this number of degrees of freedom. Up to four degrees it comes from a table. For
/// more degrees it is computed by the expansion of Cornish and Fisher, which is accurate to 0.003 from five degrees
/// on.
#[expect(clippy::cast_precision_loss, reason = "nobody walks through 2^53 halls")]
fn student(freedom: usize) -> f64 {
    const FEW: [f64; 5] = [f64::INFINITY, 12.706, 4.303, 3.182, 2.776];
    if let Some(exact) = FEW.get(freedom) {
        return *exact;
    }
    let freedom = freedom as f64;
    1.959_964 + 2.372_27 / freedom + 2.822_5 / freedom.powi(2) + 2.555_85 / freedom.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_students() {
        let estimate = Estimate::of([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).expect("there are numbers");
        assert_eq!((estimate.mean, estimate.count), (3.5, 6));
        assert!(estimate.to_string().starts_with("3.500 ± 1.9"), "{estimate}");
        // The standard deviation is 1.8708, and tables give t(5) = 2.5706.
        assert!((estimate.half_width - 1.9633).abs() < 0.01, "{estimate:?}");
        for (freedom, quantile) in [(1, 12.706), (4, 2.7764), (5, 2.5706), (10, 2.2281), (30, 2.0423), (59, 2.0010)] {
            assert!((student(freedom) - quantile).abs() < 0.004, "{freedom}");
        }
    }

    #[test]
    fn of_one_number_there_is_a_mean_and_of_none_nothing() {
        assert_eq!(Estimate::of([7.0]).map(|estimate| estimate.to_string()).as_deref(), Some("7.000"));
        assert_eq!(Estimate::of([7.0]), Some(Estimate { mean: 7.0, half_width: 0.0, count: 1 }));
        assert_eq!(Estimate::of([]), None);
    }
}
