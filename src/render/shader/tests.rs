//! Every program is valid, without a graphics card.

use wgpu::naga::front::wgsl;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

use super::{Coat, Output, Program, Shade, Subject};
use crate::render::frame::LightKind;

fn check(program: &Program<'_>) {
    let source = program.source();
    let module = wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}\n{source}", error.emit_to_string(&source)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).unwrap_or_else(|error| panic!("{}\n{source}", error.emit_to_string(&source)));
}

/// Every kind of light, by the bits of a number.
fn kind(bits: u32) -> LightKind {
    let bit = |index: u32| bits >> index & 1 == 1;
    let directional = bit(0);
    LightKind {
        directional,
        attenuated: bit(1) && !directional,
        spot: bit(2) && !directional,
        focused: bit(2) && bit(3) && !directional,
        ambient: bit(4),
        specular: bit(5),
        shadow: bit(6),
    }
}

const SURFACE: Program<'static> = Program {
    subject: Subject::Surface,
    output: Output::Color,
    coat: Coat::Plain,
    shade: Shade::Pixel,
    lights: &[],
    fog: false,
    clip: false,
};

#[test]
fn surfaces_are_valid_in_every_light() {
    for shade in [Shade::Vertex, Shade::Pixel] {
        check(&Program { shade, ..SURFACE });
        for bits in 0..1 << 7 {
            let lights = [kind(bits), LightKind { shadow: true, ..kind(bits) }];
            check(&Program { shade, lights: &lights, ..SURFACE });
        }
    }
}

#[test]
fn surfaces_are_valid_with_any_number_of_lights() {
    for shade in [Shade::Vertex, Shade::Pixel] {
        for count in 0..=8 {
            let mut lights = vec![kind(0b111_1110); count];
            lights.extend([kind(0); 3]);
            check(&Program { shade, lights: &lights, coat: Coat::Flat, fog: true, clip: true, ..SURFACE });
        }
        check(&Program { shade, lights: &[kind(0b11_0110); 100], ..SURFACE });
    }
}

#[test]
fn every_subject_is_valid_with_every_addition() {
    for subject in [Subject::Surface, Subject::Line, Subject::Depth, Subject::Sky, Subject::Label] {
        for output in [Output::Color, Output::Ids, Output::Nothing] {
            for coat in [Coat::Plain, Coat::Flat, Coat::Cube] {
                for shade in [Shade::None, Shade::Vertex, Shade::Pixel] {
                    for bits in 0..4 {
                        // What has numbers or nothing has no picture either.
                        let coat = if output == Output::Color { coat } else { Coat::Plain };
                        let lights = &[kind(0b111_1110), kind(1)];
                        let (fog, clip) = (bits & 1 == 1, bits & 2 == 2);
                        check(&Program { subject, output, coat, shade, lights, fog, clip });
                    }
                }
            }
        }
    }
}
