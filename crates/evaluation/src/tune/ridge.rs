//! Ridge regression over many numbers, most of which are 0 in each sample. It uses conjugate gradients. The diagonal
//! is the preconditioner, because the sizes of the numbers differ widely (1 to hundreds).

/// A sample. `numbers` contains pairs of index and value. A number that is missing is 0.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) target: f32,
    pub(super) numbers: Vec<(u32, f32)>,
}

/// Returns the coefficients of `size` numbers that explain the samples best. `stiffness` keeps the coefficients
/// small. The computation stops after `steps` steps, or earlier when the residual is small.
pub(super) fn ridge(samples: &[Sample], size: usize, stiffness: f64, steps: usize) -> Vec<f64> {
    let mut residual = vec![0.0; size];
    let mut diagonal = vec![stiffness; size];
    for sample in samples {
        for (n, x) in &sample.numbers {
            residual[*n as usize] += f64::from(sample.target) * f64::from(*x);
            diagonal[*n as usize] += f64::from(*x).powi(2);
        }
    }
    let conditioned = |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let mut solution = vec![0.0; size];
    let mut downhill = conditioned(&residual);
    let mut direction = downhill.clone();
    let mut norm = dot(&residual, &downhill);
    let enough = norm * 1e-7;
    for _ in 0..steps {
        if norm <= enough {
            break;
        }
        let image = apply(samples, stiffness, &direction);
        let far = norm / dot(&direction, &image);
        for n in 0..size {
            solution[n] += far * direction[n];
            residual[n] -= far * image[n];
        }
        downhill = conditioned(&residual);
        let next = dot(&residual, &downhill);
        for n in 0..size {
            direction[n] = downhill[n] + next / norm * direction[n];
        }
        norm = next;
    }
    solution
}

pub(super) fn explained(coefficients: &[f64], numbers: &[(u32, f32)]) -> f64 {
    numbers.iter().map(|(n, x)| coefficients[*n as usize] * f64::from(*x)).sum()
}

fn apply(samples: &[Sample], stiffness: f64, to: &[f64]) -> Vec<f64> {
    let mut image: Vec<f64> = to.iter().map(|x| x * stiffness).collect();
    for sample in samples {
        let sum = explained(to, &sample.numbers);
        for (n, x) in &sample.numbers {
            image[*n as usize] += sum * f64::from(*x);
        }
    }
    image
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::rng::RandomStream;

    #[test]
    fn it_finds_the_coefficients_by_which_samples_were_made() {
        let mut dice = RandomStream::new(1, "ridge");
        let truth = [3.0, -2.0, 0.0, 9.0];
        let samples: Vec<Sample> = (0..1000)
            .map(|_| {
                let numbers: Vec<(u32, f32)> = (0..4).map(|n| (n, dice.fraction() as f32)).collect();
                let noise = dice.normal(0.1);
                Sample { target: (explained(&truth, &numbers) + noise) as f32, numbers }
            })
            .collect();
        let found = ridge(&samples, 4, 0.01, 50);
        assert!(found.iter().zip(truth).all(|(a, b)| (a - b).abs() < 0.05), "{found:?}");
    }
}
