# SPDX-License-Identifier: Apache-2.0
"""gazetrace's documented surface model as Mitsuba 3 plugins, written from the formulas in its headers.

  metallic_roughness   the BSDF of src/material/bsdf.hpp with Burley's diffuse lobe; its albedos come from
                       metallic_roughness_albedo.py, not from gazetrace's tables
  rough_glass          white bodies: the facets of src/material/lobes/dielectric.hpp and ggx.hpp with what they lose put
                       back as src/material/lobes/dielectric_albedo.hpp has it
  surface_sides        around any BSDF: a shading normal is bent until its mirror direction stays above the triangle, and
                       light must lie on the same side of shading normal and triangle (src/trace/kernel/shading_frame.hpp).
                       Mitsuba itself has neither rule
  alpha_cutoff         a mask's opacity: 1 where the interpolated alpha reaches the cutoff

Import after mi.set_variant: a LLVM variant.
"""

import drjit as dr
import mitsuba as mi

import metallic_roughness_albedo as albedo


def read_table(table, cosine):
    """Linear in the root of the cosine, as metallic_roughness_albedo.py lays tables out."""
    x = dr.sqrt(dr.clip(cosine, 0, 1)) * (albedo.NODES - 1)
    k = dr.minimum(mi.UInt32(x), albedo.NODES - 2)
    low = dr.gather(mi.Float, table, k)
    return low + (dr.gather(mi.Float, table, k + 1) - low) * (x - k)


def smith_length(cosine, alpha):
    return dr.sqrt(alpha**2 + (1 - alpha**2) * cosine * cosine)


def ggx_distribution(h, alpha):
    slope2 = (h.x * h.x + h.y * h.y) / alpha**2 + h.z * h.z
    return 1 / (dr.pi * alpha**2 * slope2 * slope2)


def schlick_weight(cosine):
    return dr.clip(1 - cosine, 0, 1) ** 5


class MetallicRoughness(mi.BSDF):
    """Properties: base_color (texture), metallic and roughness (numbers). One-sided: black from behind."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base_color = props.get_texture("base_color")
        self.metallic, self.roughness = props.get("metallic", 0.0), props.get("roughness", 1.0)
        self.alpha = albedo.alpha_of(self.roughness)
        tables = albedo.albedos(self.roughness)
        self.e_average = tables.e_average
        self.e, self.burley = mi.Float(tables.e), mi.Float(tables.burley)
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def _repeated(self, f0):
        lost = 1 - self.e_average
        f = f0 + (1 - f0) / 21
        return f * f * self.e_average / (1 - f * lost) * (lost**2 / (lost**2 + 1e-6))

    def _evaluate(self, si, wo, active):
        wi = si.wi
        active &= (wi.z > 0) & (wo.z > 0)
        base = self.base_color.eval(si, active)
        f0 = mi.Color3f(albedo.DIELECTRIC_F0) * (1 - self.metallic) + base * self.metallic
        h = dr.normalize(wi + wo)
        distribution = ggx_distribution(h, self.alpha)
        visible = 0.5 / (wi.z * smith_length(wo.z, self.alpha) + wo.z * smith_length(wi.z, self.alpha))
        fresnel = f0 + (1 - f0) * schlick_weight(dr.dot(wi, h))

        repeats = self._repeated(base) * self.metallic + self._repeated(albedo.DIELECTRIC_F0) * (1 - self.metallic)
        lost = (1 - read_table(self.e, wi.z)) * (1 - read_table(self.e, wo.z))
        multiple = repeats * lost / (dr.pi * max(1 - self.e_average, 1e-7))

        t = self.roughness * (1 + dr.dot(wi, wo)) - 0.5
        shape = (1 + t * schlick_weight(wi.z)) * (1 + t * schlick_weight(wo.z))
        scale = read_table(self.burley, wi.z) * read_table(self.burley, wo.z)
        diffuse = base * ((1 - self.metallic) * scale * shape / dr.pi)

        value = (fresnel * (distribution * visible) + multiple + diffuse) * wo.z
        normal_pdf = distribution * 0.5 / (wi.z + smith_length(wi.z, self.alpha))
        pdf = 0.5 * normal_pdf + 0.5 * wo.z / dr.pi
        return dr.select(active, value, 0), dr.select(active, pdf, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        wi = si.wi
        active &= wi.z > 0
        ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)
        facet, _ = ggx.sample(wi, sample2)
        cosine = mi.warp.square_to_cosine_hemisphere(sample2)
        bs = mi.BSDFSample3f()
        bs.wo = dr.select(sample1 < 0.5, mi.reflect(wi, facet), cosine)
        value, bs.pdf = self._evaluate(si, bs.wo, active)
        bs.eta = 1.0
        bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        bs.sampled_component = 0
        return bs, dr.select(bs.pdf > 0, value / bs.pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)

    def traverse(self, callback):
        pass

    def to_string(self):
        return f"MetallicRoughness[roughness={self.roughness}, metallic={self.metallic}]"


class RoughGlass(mi.BSDF):
    """Properties: roughness and ior (numbers). Directions are turned so that the viewer's has z > 0: o, the other i."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.roughness, self.ior = props.get("roughness", 0.5), props.get("ior", 1.5)
        self.alpha = albedo.alpha_of(self.roughness)
        tables = albedo.glass_albedos(self.roughness, self.ior)
        self.lost = [mi.Float(x) for x in tables.lost]
        self.average = [max(x, 1e-7) for x in tables.lost_average]
        least = min(tables.lost_average)
        self.shown = least**2 / (least**2 + 1e-6)
        # Both sides pass the same flux: the share that passes, of light from outside and from inside.
        self.passed = [tables.passed_average * least / (self.average[k] * (1, self.ior**2)[k]) for k in (0, 1)]
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide | mi.BSDFFlags.NonSymmetric
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.GlossyTransmission | sides]
        self.m_flags = self.m_components[0]

    def _fresnel(self, cosine, eta):
        sin2 = (1 - cosine * cosine) / (eta * eta)
        through = dr.safe_sqrt(1 - sin2)
        parallel = (eta * cosine - through) / (eta * cosine + through)
        perpendicular = (cosine - eta * through) / (cosine + eta * through)
        return dr.select(sin2 >= 1, 1, 0.5 * (parallel * parallel + perpendicular * perpendicular))

    def _either(self, pair, first):
        return dr.select(first, mi.Float(pair[0]), mi.Float(pair[1]))

    def _evaluate(self, si, wo, active):
        outside = si.wi.z > 0
        turn = dr.select(outside, mi.Float(1), mi.Float(-1))
        o, i = mi.Vector3f(si.wi.x, si.wi.y, si.wi.z * turn), mi.Vector3f(wo.x, wo.y, wo.z * turn)
        eta = self._either((self.ior, 1 / self.ior), outside)
        through = i.z < 0
        height = dr.abs(i.z)
        active &= (o.z > 0) & (height > 0)

        h = dr.normalize(o + i * dr.select(through, eta, 1))
        h = dr.select(h.z < 0, -h, h)
        o_dot_h, i_dot_h = dr.dot(o, h), dr.dot(i, h)
        facing = (o_dot_h > 0) & (~through | (i_dot_h < 0))
        distribution = ggx_distribution(h, self.alpha)
        length = smith_length(o.z, self.alpha)
        masking = 1 / (o.z * smith_length(height, self.alpha) + height * length)
        f = self._fresnel(dr.minimum(o_dot_h, 1), eta)
        s = o_dot_h + eta * i_dot_h
        squeezed = -2 * i_dot_h * o_dot_h / (s * s)
        facets = dr.select(through, (1 - f) * squeezed, 0.5 * f) * distribution * masking
        normal_pdf = 2 * o_dot_h * distribution / (o.z + length)
        jacobian = dr.select(through, eta * eta * dr.abs(i_dot_h) / (s * s), 1 / (4 * o_dot_h))
        facet_pdf = dr.select(through, 1 - f, f) * normal_pdf * jacobian

        there = outside ^ through  # i is outside
        lost_o = dr.select(outside, read_table(self.lost[0], o.z), read_table(self.lost[1], o.z))
        lost_i = dr.select(there, read_table(self.lost[0], height), read_table(self.lost[1], height))
        lobe = lost_o * lost_i * self.shown / (dr.pi * self._either(self.average, there))
        passed = self._either(self.passed, outside)
        multiple = lobe * dr.select(through, passed / (eta * eta), 1 - passed)

        value = (dr.select(facing, facets, 0) + multiple) * height
        pdf = 0.8 * dr.select(facing, facet_pdf, 0) + 0.1 * height / dr.pi
        return mi.Color3f(dr.select(active, value, 0)), dr.select(active, pdf, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        outside = si.wi.z > 0
        turn = dr.select(outside, mi.Float(1), mi.Float(-1))
        o = mi.Vector3f(si.wi.x, si.wi.y, si.wi.z * turn)
        eta = self._either((self.ior, 1 / self.ior), outside)
        h, _ = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True).sample(o, sample2)
        o_dot_h = dr.dot(o, h)
        f = self._fresnel(dr.minimum(o_dot_h, 1), eta)
        bent = h * (o_dot_h / eta - dr.safe_sqrt(1 - (1 - o_dot_h * o_dot_h) / (eta * eta))) - o / eta
        cosine = mi.warp.square_to_cosine_hemisphere(sample2)
        spread = dr.select(sample1 < 0.9, cosine, mi.Vector3f(cosine.x, cosine.y, -cosine.z))
        facet = dr.select(sample1 < 0.8 * f, mi.reflect(o, h), dr.normalize(bent))
        # A facet that sends light to the wrong side sends it into other facets: lost here, put back by the broad lobe.
        sound = (sample1 >= 0.8) | (dr.select(sample1 < 0.8 * f, facet.z, -facet.z) > 0)
        i = dr.select(sample1 < 0.8, facet, spread)
        bs = mi.BSDFSample3f()
        bs.wo = mi.Vector3f(i.x, i.y, i.z * turn)
        value, bs.pdf = self._evaluate(si, bs.wo, active & sound)
        bs.eta = dr.select(i.z < 0, eta, 1)
        bs.sampled_type = dr.select(i.z < 0, mi.UInt32(+mi.BSDFFlags.GlossyTransmission),
                                    mi.UInt32(+mi.BSDFFlags.GlossyReflection))
        bs.sampled_component = 0
        return bs, dr.select(bs.pdf > 0, value / bs.pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        return self._evaluate(si, wo, active)

    def traverse(self, callback):
        pass

    def to_string(self):
        return f"RoughGlass[roughness={self.roughness}, ior={self.ior}]"


def bend_normal(shading, geometric, view):
    """The normal nearest to `shading` whose mirror direction rises above `geometric`; all on the viewer's side."""
    cosine = dr.dot(shading, view)
    mirrored = shading * (2 * cosine) - view
    height = dr.dot(mirrored, geometric)
    least = dr.minimum(0.01, 0.5 * dr.dot(view, geometric))
    bent = dr.normalize(mirrored + geometric * (least - height)) + view
    sound = dr.squared_norm(bent) > 1e-12
    return dr.select((cosine > 0) & (height >= least), shading, dr.select(sound, dr.normalize(bent), geometric))


class SurfaceSides(mi.BSDF):
    """Properties: bsdf; transmits (else the surface is lit and seen from both sides alike)."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.nested, self.transmits = props["bsdf"], props.get("transmits", False)
        self.m_components = [self.nested.flags(i) for i in range(self.nested.component_count())]
        self.m_flags = self.nested.flags()

    def _turned(self, si):
        """The interaction as the nested BSDF sees it, and the triangle's normal on the side of its shading normal."""
        view = si.to_world(si.wi)
        side = dr.select(dr.dot(si.n, view) < 0, mi.Float(-1), mi.Float(1))
        geometric = si.n * side
        normal = bend_normal(si.sh_frame.n * side, geometric, view)
        if self.transmits:
            normal, geometric = normal * side, si.n
        turned = mi.SurfaceInteraction3f(si)
        turned.sh_frame = mi.Frame3f(normal)
        turned.wi = turned.to_local(view)
        return turned, geometric

    @staticmethod
    def _agrees(local, world, geometric):
        return local.z * dr.dot(world, geometric) > 0

    def sample(self, ctx, si, sample1, sample2, active=True):
        turned, geometric = self._turned(si)
        bs, weight = self.nested.sample(ctx, turned, sample1, sample2, active)
        world = turned.to_world(bs.wo)
        good = self._agrees(bs.wo, world, geometric) & active
        bs.wo = si.to_local(world)
        return bs, dr.select(good, weight, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        turned, geometric = self._turned(si)
        world = si.to_world(wo)
        local = turned.to_local(world)
        value, pdf = self.nested.eval_pdf(ctx, turned, local, active)
        # The density stays where the value is 0: the next ray may be drawn there all the same.
        return dr.select(self._agrees(local, world, geometric) & active, value, 0), pdf

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def traverse(self, callback):
        pass

    def to_string(self):
        return "SurfaceSides"


class AlphaCutoff(mi.Texture):
    """Properties: alpha (texture), cutoff."""

    def __init__(self, props):
        mi.Texture.__init__(self, props)
        self.alpha, self.cutoff = props["alpha"], props.get("cutoff", 0.5)

    def eval_1(self, si, active=True):
        return dr.select(self.alpha.eval_1(si, active) >= self.cutoff, mi.Float(1), mi.Float(0))

    def eval(self, si, active=True):
        return mi.Color3f(self.eval_1(si, active))

    def mean(self):
        return self.alpha.mean()

    def max(self):
        return 1.0

    def is_spatially_varying(self):
        return True

    def traverse(self, callback):
        pass

    def to_string(self):
        return "AlphaCutoff"


def register():
    mi.register_bsdf("metallic_roughness", MetallicRoughness)
    mi.register_bsdf("rough_glass", RoughGlass)
    mi.register_bsdf("surface_sides", SurfaceSides)
    mi.register_texture("alpha_cutoff", AlphaCutoff)
