//! Prints every constant of judgement as TOML: a file for `kufe discover --rules`, to be changed line by line.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", kufe_discover::Rules::default().to_toml()?);
    Ok(())
}
