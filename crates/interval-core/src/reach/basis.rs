//! Monomials of the symbols of the start, up to a degree, and how they multiply.

/// Monomials in symbols that lie in \[-1, 1\], by degree; the first is 1.
pub struct Basis {
    /// Degree of each monomial.
    pub degrees: Vec<usize>,
    /// Whether all powers of a monomial are even, so that its values lie in \[0, 1\].
    pub even: Vec<bool>,
    /// Triples: the monomial that the product of two is.
    pub products: Vec<[usize; 3]>,
    /// The most products that meet in one monomial.
    pub meeting: usize,
    /// The largest degree.
    pub degree: usize,
}

impl Basis {
    /// Monomials of `symbols` symbols up to `degree`.
    pub fn new(symbols: usize, degree: usize) -> Self {
        let mut powers = vec![vec![0_usize; symbols]];
        let mut last = powers.clone();
        for _ in 0..degree {
            let mut next = Vec::new();
            for monomial in &last {
                // A symbol below the last one present would give the same monomial again.
                let first = monomial.iter().rposition(|&power| power > 0).unwrap_or(0);
                for symbol in first..symbols {
                    let mut higher: Vec<usize> = monomial.clone();
                    higher[symbol] += 1;
                    next.push(higher);
                }
            }
            powers.extend(next.iter().cloned());
            last = next;
        }
        let places: std::collections::BTreeMap<&[usize], usize> =
            powers.iter().enumerate().map(|(place, monomial)| (monomial.as_slice(), place)).collect();
        let degrees: Vec<usize> = powers.iter().map(|monomial| monomial.iter().sum()).collect();
        let mut products = Vec::new();
        let mut meetings = vec![0; powers.len()];
        for (i, left) in powers.iter().enumerate() {
            for (j, right) in powers.iter().enumerate() {
                if degrees[i] + degrees[j] <= degree {
                    let both: Vec<usize> = left.iter().zip(right).map(|(a, b)| a + b).collect();
                    let place = places[both.as_slice()];
                    meetings[place] += 1;
                    products.push([i, j, place]);
                }
            }
        }
        let even = powers.iter().map(|monomial| monomial.iter().all(|power| power % 2 == 0)).collect();
        let meeting = meetings.into_iter().max().unwrap_or(1);
        Self { degrees, even, products, meeting, degree }
    }

    /// The number of monomials.
    pub fn len(&self) -> usize {
        self.degrees.len()
    }
}
