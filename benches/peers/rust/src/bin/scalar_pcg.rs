//! Scalar Rust, generator `rand_pcg::Pcg64Mcg`.

fn main() {
    peers::measure(peers::scalar::paths::<rand_pcg::Pcg64Mcg>);
}
