//! Rows and bounds as the numbers of a `std_msgs/Float64MultiArray`.
//!
//! A row is `time, y.lo, y.hi` and for each parameter `a.lo, a.hi`. An answer is `time, 0` and for each parameter its two
//! bounds, or `time, 1, oldest` where no parameters explain the rows: time of the oldest row that the proof names.

use onboard::{Bounds, Follower, State};

/// Half-spaces that are kept: 64 kB for nine parameters.
const ROWS: usize = 304;

/// A follower behind a topic.
pub struct Topic<const N: usize> {
    follower: Box<Follower<N, ROWS>>,
}

impl<const N: usize> Topic<N> {
    /// Follows parameters that lie within `start`.
    ///
    /// # Errors
    /// A start that is not finite and ordered, in one sentence.
    pub fn new(start: Bounds) -> Result<Self, String> {
        let follower = Follower::new([start; N]).map_err(|e| e.to_string())?;
        Ok(Self { follower: Box::new(follower) })
    }

    /// The answer to a row.
    ///
    /// # Errors
    /// Numbers that are no row, in one sentence; the follower is as it was.
    pub fn answer(&mut self, data: &[f64]) -> Result<Vec<f64>, String> {
        let needed = 3 + 2 * N;
        if data.len() != needed {
            return Err(format!("a row of {} numbers came; time, y.lo, y.hi and {N} pairs are {needed}", data.len()));
        }
        let a: [Bounds; N] = std::array::from_fn(|j| Bounds::new(data[3 + 2 * j], data[4 + 2 * j]));
        let state = self.follower.row(data[0], &a, Bounds::new(data[1], data[2])).map_err(|e| e.to_string())?;
        Ok(match state {
            State::Bounded => {
                let ends = self.follower.bounds().iter().flat_map(|x| [x.lo, x.hi]);
                [data[0], 0.0].into_iter().chain(ends).collect()
            }
            State::Empty(proof) => vec![data[0], 1.0, proof.oldest],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_gets_the_bounds_and_a_contradiction_its_proof() {
        let mut topic = Topic::<1>::new(Bounds::new(-10.0, 10.0)).expect("a good start");
        assert_eq!(topic.answer(&[0.5, 1.0, 2.0, 1.0, 1.0]), Ok(vec![0.5, 0.0, 1.0, 2.0]));
        let empty = topic.answer(&[1.5, 3.0, 4.0, 1.0, 1.0]).expect("a row");
        assert_eq!(empty[..2], [1.5, 1.0]);
    }

    #[test]
    fn other_numbers_are_refused_in_a_sentence() {
        let mut topic = Topic::<1>::new(Bounds::new(-10.0, 10.0)).expect("a good start");
        assert!(topic.answer(&[0.5, 1.0]).unwrap_err().contains("are 5"));
        assert!(topic.answer(&[0.5, 2.0, 1.0, 1.0, 1.0]).unwrap_err().contains("reversed"));
        assert!(Topic::<1>::new(Bounds::ENTIRE).is_err());
    }
}
