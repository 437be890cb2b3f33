//! Prints the thresholds of a search as TOML: a file for `kufe discover --rules`, to be changed
//! line by line. What each does is in the documentation of `kufe_discover::Rules`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", kufe_discover::Rules::default().to_toml()?);
    Ok(())
}
