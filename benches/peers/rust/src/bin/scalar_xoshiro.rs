//! Scalar Rust, generator `rand_xoshiro::Xoshiro256PlusPlus`.

fn main() {
    peers::measure(peers::scalar::paths::<rand_xoshiro::Xoshiro256PlusPlus>);
}
