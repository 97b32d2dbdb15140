mod display;
mod hand;
fn main() {}
