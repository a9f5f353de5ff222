# SPDX-License-Identifier: Apache-2.0
"""What Blender's importers leave out or guess of materials: pictures that are not there, and the gloss of older models of surfaces."""

import re
from pathlib import Path

# Of lights in USD that state none; Blender writes it for lights without a temperature, too.
NEUTRAL_K = 6500


def settle(bpy, path):
    """Gives materials the gloss that the file states, where Blender's importer did not; what stays lost, in a sentence each."""
    suffix = path.suffix.lower()
    lost = missing_pictures(bpy, path)
    if suffix == ".fbx":
        lost += settle_fbx_gloss(bpy, path)
    if suffix.startswith(".usd"):
        names = [f"'{item.name}'" for item in bpy.data.lights if getattr(item, "use_temperature", False) and item.temperature == NEUTRAL_K]
        if names:
            lost.append(f"The file states {NEUTRAL_K} K for {', '.join(names)}, which Blender also writes for lights without a temperature: "
                        "red and blue are 6 and 5 % above green.")
    return lost


def missing_pictures(bpy, path):
    """Pictures that the file names and that do not lie there."""
    if path.suffix.lower() != ".obj":
        absent = {image.filepath for image in bpy.data.images if image.source == "FILE" and image.packed_file is None
                  and not Path(bpy.path.abspath(image.filepath, library=image.library)).is_file()}
    else:  # Blender's importer does not keep what it cannot load
        absent = set()
        for library in re.findall(r"^mtllib\s+(.+?)\s*$", path.read_text(errors="replace"), re.MULTILINE):
            file = path.parent / library
            if not file.is_file():
                absent.add(library)
                continue
            for words in re.findall(r"^\s*(?:map_\w+|bump|disp|norm|refl)\s+(.+?)\s*$", file.read_text(errors="replace"), re.MULTILINE):
                # Options with values of their own stand before the name, which may have spaces.
                names = [words.split(None, skipped)[-1] for skipped in range(len(words.split()))]
                if not any((file.parent / name.replace("\\", "/")).is_file() for name in names):
                    absent.add(words)
    return [f"Picture '{name}' is not there: its material is without it." for name in sorted(absent)]


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
    """Who wrote the file, and of each material its model and its factor of gloss, None where it states none."""
    data = path.read_bytes()
    if data.startswith(b"Kaydara FBX Binary"):
        from io_scene_fbx import parse_fbx  # Blender's own, beside its importer
        try:
            root, _ = parse_fbx.parse(str(path))
        except (OSError, ValueError):
            return "", {}
        parts = {element.id: element for element in root.elems}
        creator = parts[b"Creator"].props[0].decode(errors="replace") if b"Creator" in parts else ""
        stated = {}
        for material in parts[b"Objects"].elems if b"Objects" in parts else []:
            if material.id == b"Material":
                name = material.props[1].split(b"\0\1")[0].decode(errors="replace")
                model = next((part.props[0].decode(errors="replace").lower() for part in material.elems if part.id == b"ShadingModel"), "")
                values = [value.props for part in material.elems if part.id == b"Properties70" for value in part.elems]
                stated[name] = model, next((props[4] for props in values if props[0] == b"SpecularFactor"), None)
        return creator, stated
    text = data.decode(errors="replace")
    creator = re.search(r'^\s*Creator:\s*"([^"]*)"', text, re.MULTILINE)
    stated = {}
    for name, body in re.findall(r'^\tMaterial: [^"\n]*"Material::([^"]*)"[^{\n]*\{(.*?)^\t\}', text, re.MULTILINE | re.DOTALL):
        model = re.search(r'ShadingModel:\s*"(\w*)"', body)
        factor = re.search(r'"SpecularFactor"(?:\s*,\s*"[^"]*")*\s*,\s*([-+.\deE]+)', body)
        stated[name] = model[1].lower() if model else "", float(factor[1]) if factor else None
    return creator[1] if creator else "", stated
