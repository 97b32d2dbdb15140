//! Meshes, skins, height fields, textures and materials.

use mujoco_safe::sys;

use super::{check_fields, int, models, on_model, optional, raw, span, start};
use crate::twins::{differing, read};

#[test]
fn fields_of_meshes_and_skins_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let number = |adr: *const i32, num: *const i32, i| if raw(adr, i) < 0 { 0 } else { int(num, i) };
        let places = differing::MeshPlaces::of(m);
        check_fields!(name, model.meshes(), |mesh, i| {
            vert: m.mesh_vert, [3 * int(m.mesh_vertadr, i); 3 * int(m.mesh_vertnum, i)];
            normal: m.mesh_normal, [3 * int(places.normaladr, i); 3 * int(places.normalnum, i)];
            texcoord: m.mesh_texcoord, [2 * start(m.mesh_texcoordadr, i); 2 * number(m.mesh_texcoordadr, places.texcoordnum, i)];
            face: m.mesh_face, [3 * int(m.mesh_faceadr, i); 3 * int(m.mesh_facenum, i)];
            facenormal: places.facenormal, [3 * int(m.mesh_faceadr, i); 3 * int(m.mesh_facenum, i)];
            facetexcoord: places.facetexcoord, [3 * int(m.mesh_faceadr, i); 3 * number(m.mesh_texcoordadr, m.mesh_facenum, i)];
            => vert_range: mesh.vert_range(), span(m.mesh_vertadr, m.mesh_vertnum, i);
            => texcoord_range: mesh.texcoord_range(), span(m.mesh_texcoordadr, places.texcoordnum, i);
            => normal_range: mesh.normal_range(), span(places.normaladr, places.normalnum, i);
            => face_range: mesh.face_range(), span(m.mesh_faceadr, m.mesh_facenum, i);
            => graph: mesh.graph().map(<[i32]>::to_vec), graph(m, i);
        });
        check_fields!(name, model.skins(), |skin, i| {
            group: m.skin_group, [i; 1];
            rgba: m.skin_rgba, [4 * i; 4];
            inflate: m.skin_inflate, [i; 1];
            vert: m.skin_vert, [3 * int(m.skin_vertadr, i); 3 * int(m.skin_vertnum, i)];
            texcoord: m.skin_texcoord, [2 * start(m.skin_texcoordadr, i); 2 * number(m.skin_texcoordadr, m.skin_vertnum, i)];
            face: m.skin_face, [3 * int(m.skin_faceadr, i); 3 * int(m.skin_facenum, i)];
            bonebindpos: m.skin_bonebindpos, [3 * int(m.skin_boneadr, i); 3 * int(m.skin_bonenum, i)];
            bonebindquat: m.skin_bonebindquat, [4 * int(m.skin_boneadr, i); 4 * int(m.skin_bonenum, i)];
            bonevertweight: m.skin_bonevertweight, [weights(m, i).start; weights(m, i).len()];
            => material: optional(skin.material()), raw(m.skin_matid, i);
            => vert_range: skin.vert_range(), span(m.skin_vertadr, m.skin_vertnum, i);
            => texcoord_range: skin.texcoord_range(), span(m.skin_texcoordadr, m.skin_vertnum, i);
            => face_range: skin.face_range(), span(m.skin_faceadr, m.skin_facenum, i);
            => bone_range: skin.bone_range(), span(m.skin_boneadr, m.skin_bonenum, i);
            => bonevert_range: skin.bonevert_range(), weights(m, i);
            => bones: skin.bones().map(|bone| (bone.body.index(), bone.vertid.to_vec(), bone.vertweight.to_vec())).collect::<Vec<_>>(),
                span(m.skin_boneadr, m.skin_bonenum, i).map(|bone| bone_of(m, bone)).collect::<Vec<_>>();
        });
    }
}

/// Returns the convex hull: two numbers, two for each vertex, one for each edge (the number of
/// vertices plus three times the number of faces), and three for each face.
fn graph(m: &sys::mjModel, mesh: usize) -> Option<Vec<i32>> {
    let start = usize::try_from(raw(m.mesh_graphadr, mesh)).ok()?;
    let (vertices, faces) = (int(m.mesh_graph, start), int(m.mesh_graph, start + 1));
    let length = 2 + 2 * vertices + (vertices + 3 * faces) + 3 * faces;
    // The compiler stores the hulls one after another.
    let rest = (0..m.nmesh as usize).map(|other| raw(m.mesh_graphadr, other)).filter(|other| *other > start as i32);
    let end = rest.min().map_or(m.nmeshgraph as usize, |end| end as usize);
    assert_eq!(start + length, end, "the hull of mesh {mesh} ends where the next begins");
    // SAFETY: the length follows from the engine's sizes.
    Some(unsafe { read(m.mesh_graph, start, length) })
}

/// Returns the range of the weights of all bones of a skin.
fn weights(m: &sys::mjModel, skin: usize) -> std::ops::Range<usize> {
    let bones = span(m.skin_boneadr, m.skin_bonenum, skin);
    int(m.skin_bonevertadr, bones.start)..span(m.skin_bonevertadr, m.skin_bonevertnum, bones.end - 1).end
}

fn bone_of(m: &sys::mjModel, bone: usize) -> (usize, Vec<i32>, Vec<f32>) {
    let (start, count) = (int(m.skin_bonevertadr, bone), int(m.skin_bonevertnum, bone));
    // SAFETY: the engine's arrays have an element for each vertex of each bone.
    unsafe {
        (int(m.skin_bonebodyid, bone), read(m.skin_bonevertid, start, count), read(m.skin_bonevertweight, start, count))
    }
}

#[test]
fn fields_of_height_fields_textures_and_materials_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        check_fields!(name, model.height_fields(), |field, i| {
            size: m.hfield_size, [4 * i; 4];
            data: m.hfield_data, [int(m.hfield_adr, i); int(m.hfield_nrow, i) * int(m.hfield_ncol, i)];
            => nrow: field.nrow(), int(m.hfield_nrow, i);
            => ncol: field.ncol(), int(m.hfield_ncol, i);
            => data_range: (field.data_range().start, field.data_range().len()),
                (int(m.hfield_adr, i), int(m.hfield_nrow, i) * int(m.hfield_ncol, i));
        });
        // SAFETY: the textures and materials of the model.
        let channels = |i| unsafe { differing::texture_channels(m, i) };
        // SAFETY: as above.
        let material_texture = |i| unsafe { differing::material_texture(m, i) };
        check_fields!(name, model.textures(), |texture, i| {
            rgb: differing::texture_bytes(m), [int(m.tex_adr, i); channels(i) * int(m.tex_height, i) * int(m.tex_width, i)];
            => texture_type: texture.texture_type() as i32, raw(m.tex_type, i);
            => channels: texture.channels(), channels(i);
            => height: texture.height(), int(m.tex_height, i);
            => width: texture.width(), int(m.tex_width, i);
            => rgb_range: (texture.rgb_range().start, texture.rgb_range().len()),
                (int(m.tex_adr, i), channels(i) * int(m.tex_height, i) * int(m.tex_width, i));
        });
        check_fields!(name, model.materials(), |material, i| {
            texuniform: m.mat_texuniform, [i; 1];
            texrepeat: m.mat_texrepeat, [2 * i; 2];
            emission: m.mat_emission, [i; 1];
            specular: m.mat_specular, [i; 1];
            shininess: m.mat_shininess, [i; 1];
            reflectance: m.mat_reflectance, [i; 1];
            rgba: m.mat_rgba, [4 * i; 4];
            => texture: optional(material.texture()), material_texture(i);
        });
    }
}
