# SPDX-License-Identifier: Apache-2.0
"""What Blender's importers leave out or guess of materials: files that are not there, and the gloss of older models of surfaces."""

import os
import re
from pathlib import Path

# Of lights in USD that state none; Blender writes it for lights without a temperature, too.
NEUTRAL_K = 6500


def settle(bpy, path):
    """Gives materials the gloss that the file states, where Blender's importer did not; what stays lost, in a sentence each."""
    suffix = path.suffix.lower()
    lost = lost_obj_materials(path) if suffix == ".obj" else []
    lost += missing_pictures(bpy, path)
    if suffix == ".fbx":
        lost += settle_fbx_gloss(bpy, path)
    if suffix.startswith(".usd"):
        names = [f"'{item.name}'" for item in bpy.data.lights if getattr(item, "use_temperature", False) and item.temperature == NEUTRAL_K]
        if names:
            lost.append(f"The file states {NEUTRAL_K} K for {', '.join(names)}, which Blender also writes for lights without a temperature: "
                        "red and blue are 6 and 5 % above green.")
    return lost


def missing_pictures(bpy, path):
    """Pictures that something uses and that Blender could not load. Its importers keep the name of what they did not find."""
    sentences = set()
    for image in bpy.data.images:
        is_used = image.users > image.use_fake_user  # a fake user keeps what nothing else holds
        if image.source not in ("FILE", "TILED") or not is_used or not image.filepath or image.packed_file is not None:
            continue
        files = files_of(bpy, image)
        absent = [file for file in files if not os.path.isfile(file)]
        # The exporter drops a picture without pixels, too.
        unread = files[:1] if not absent and image.source == "FILE" and 0 in image.size else []
        sentences.update(f"Picture '{shown(file, path)}' is not there and is left out." for file in absent)
        sentences.update(f"Picture '{shown(file, path)}' cannot be read and is left out." for file in unread)
    return sorted(sentences)


def files_of(bpy, image):
    """The file of an image, or of each tile."""
    if image.source == "FILE":
        return [image.filepath_from_user()]
    pattern = bpy.path.abspath(image.filepath, library=image.library)
    return [pattern.replace("<UDIM>", str(tile.number)) for tile in image.tiles]


def shown(file, scene):
    """A file's name as seen from the scene, where it lies below it."""
    folder = os.path.join(os.path.abspath(scene.parent), "")
    return os.path.abspath(file).removeprefix(folder)


def lost_obj_materials(path):
    """Materials that an OBJ uses and that no file defines of those that Blender reads: one a line, and that of the OBJ's own name."""
    libraries, used = [], set()
    for keyword, name in statements(path, "mtllib", "usemtl"):
        if keyword == "usemtl":
            used.add(name)
        else:
            libraries.append(name[1:-1] if len(name) > 2 and name[0] == name[-1] == '"' else name)
    own = path.with_suffix(".mtl")
    libraries += [own.name] if own.exists() else []
    reasons = []
    for library in dict.fromkeys(libraries):
        file = Path(f"{path.parent}/{library}")  # Blender looks for /a.mtl there, too
        if file.is_file():
            used -= {name for _, name in statements(file, "newmtl")}
            continue
        for name in re.split(r"(?<=\.mtl)\s+", library, flags=re.IGNORECASE):
            is_there = (path.parent / name).is_file()
            reasons.append(f"Blender does not read '{name}', one of several in its line" if is_there else f"'{name}' is not there")
    names = ", ".join(f"'{name}'" for name in sorted(used))
    subject = f"Materials {names} are" if len(used) > 1 else f"Material {names} is"
    return [f"{subject} left out: {'; '.join(reasons) or 'no file defines it'}."] if used else []


def statements(path, *keywords):
    """What stands behind keywords in the lines of a file that may be large."""
    wanted = tuple(keyword.encode() for keyword in keywords)
    with path.open("rb") as file:
        for line in file:
            words = line.split(None, 1) if line.lstrip().startswith(wanted) else []
            if len(words) == 2 and words[0] in wanted:
                yield words[0].decode(), words[1].strip().decode(errors="replace")


def settle_fbx_gloss(bpy, path):
    """FBX has Lambert's model, without gloss, and Phong's, of which Blender's add-on writes its own strength as half of it; the
    newer importer has a dielectric of 0.5 for all."""
    creator, stated = fbx_surfaces(path)
    guessed = []
    for material in bpy.data.materials:
        model, factor = stated.get(material.name, ("", None))
        surfaces = [node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"] if material.node_tree else []
        for surface in surfaces:
            strength = surface.inputs.get("Specular IOR Level") or surface.inputs["Specular"]
            if model == "lambert" or factor == 0:
                strength.default_value = 0
            elif factor is not None and creator.startswith("Blender"):
                strength.default_value = min(1, 2 * factor)
            else:
                guessed.append(f"'{material.name}'")
        if model == "lambert":
            for surface in surfaces:
                surface.inputs["Roughness"].default_value = 1
    return [f"The gloss of {', '.join(guessed)} is Blender's guess: glTF has no model of Phong."] if guessed else []


def fbx_surfaces(path):
    """Who wrote the file, and of each material its model and its factor of gloss, None where it states none; nothing of a
    file that Blender's importer has read and that cannot be read here."""
    data = path.read_bytes()
    try:
        return surfaces_of_binary_fbx(path) if data.startswith(b"Kaydara FBX Binary") else surfaces_of_fbx_text(data.decode(errors="replace"))
    except Exception:  # Blender's parser checks little: damage shows itself as errors of struct, zlib, lists and others
        return "", {}


def surfaces_of_binary_fbx(path):
    from io_scene_fbx import parse_fbx  # Blender's own, beside its older importer
    root, _ = parse_fbx.parse(str(path))
    parts = {element.id: element for element in root.elems}
    creator = parts[b"Creator"].props[0].decode(errors="replace") if b"Creator" in parts else ""
    stated = {}
    for material in parts[b"Objects"].elems if b"Objects" in parts else []:
        if material.id == b"Material":
            name = material.props[1].split(b"\0\1")[0].decode(errors="replace")
            model = next((part.props[0].decode(errors="replace").lower() for part in material.elems if part.id == b"ShadingModel"), "")
            values = [value.props for part in material.elems if part.id == b"Properties70" for value in part.elems]
            stated[name] = model, next((float(props[4]) for props in values if props[0] == b"SpecularFactor"), None)
    return creator, stated


def surfaces_of_fbx_text(text):
    creator = re.search(r'^\s*Creator:\s*"([^"]*)"', text, re.MULTILINE)
    stated = {}
    # A material ends where a brace stands as deep as its name.
    for _, name, body in re.findall(r'^([ \t]*)Material:[^"\n]*"Material::([^"]*)"[^{\n]*\{(.*?)^\1\}', text, re.MULTILINE | re.DOTALL):
        model = re.search(r'ShadingModel:\s*"(\w*)"', body)
        factor = re.search(r'"SpecularFactor"(?:\s*,\s*"[^"]*")*\s*,\s*([-+.\deE]+)', body)
        stated[name] = model[1].lower() if model else "", float(factor[1]) if factor else None
    return creator[1] if creator else "", stated
