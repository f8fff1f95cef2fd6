//! Sampling schemes: the dependence of the replicas of a surface on each other.

/// Replicas of a stratified group, and strata of the normal distribution.
pub const STRATA: u64 = 8;

/// The dependence of the replicas of an ensemble on each other. Whatever the scheme, one replica by
/// itself is N independent asperities, and groups of replicas are independent of each other.
///
/// # Examples
/// ```
/// use stiction::surface::SamplingScheme;
///
/// let antithetic = SamplingScheme::Antithetic;
/// assert_eq!(antithetic.group(), 2);
/// assert!(antithetic.check(64).is_ok() && antithetic.check(65).is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplingScheme {
    /// Each replica by itself.
    #[default]
    Independent,
    /// Pairs of replicas with the same heights of opposite sign, of a law that is not symmetric with as many below one as
    /// above the other (Hammersley and Morton 1956).
    Antithetic,
    /// Groups of [`STRATA`] replicas, in which each asperity has a height in each of as many equally probable
    /// strata: Latin hypercube sampling (McKay, Beckman and Conover 1979).
    Stratified,
}

impl SamplingScheme {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 3] = [
        ("independent", Self::Independent),
        ("antithetic", Self::Antithetic),
        ("stratified", Self::Stratified),
    ];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Antithetic => "antithetic",
            Self::Stratified => "stratified",
        }
    }

    /// Replicas of a group, which depend on each other; 1 when none do.
    pub fn group(self) -> u64 {
        match self {
            Self::Independent => 1,
            Self::Antithetic => 2,
            Self::Stratified => STRATA,
        }
    }

    /// Checks that `replicas` are whole groups.
    ///
    /// # Errors
    /// A text that says what would do.
    pub fn check(self, replicas: u64) -> Result<(), String> {
        let group = self.group();
        if replicas.is_multiple_of(group) {
            return Ok(());
        }
        let below = replicas / group * group;
        let such = if below == 0 { String::new() } else { format!("{below} or ") };
        let name = self.name();
        Err(format!(
            "sampling = \"{name}\" needs a multiple of {group} replicas, such as {such}{}",
            below + group
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_list() {
        assert!(SamplingScheme::ALL.iter().all(|(name, scheme)| scheme.name() == *name));
    }

    #[test]
    fn what_would_do_is_said() {
        assert_eq!(SamplingScheme::Independent.check(7), Ok(()));
        assert_eq!(SamplingScheme::Stratified.check(16), Ok(()));
        let refused = SamplingScheme::Stratified.check(201).unwrap_err();
        assert_eq!(refused, "sampling = \"stratified\" needs a multiple of 8 replicas, such as 200 or 208");
        assert!(SamplingScheme::Antithetic.check(1).unwrap_err().ends_with("such as 2"));
    }
}
