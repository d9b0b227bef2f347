"""Textured rooms with moving objects, ray-cast in PyTorch: images for the fixtures and for timing.

In the manner of docs/model.md section 9, but not what `vkopple generate` draws: boxes, spheres and cylinders only.
Scene units, radians; camera frame x right, y forward, z up.
"""
import math

import torch

ROOM, HEIGHT, EYE = 2.5, 2.5, 0.7


def sample_scenes(n, frames, generator, objects=3, size=(0.25, 0.5), speed=0.12, step=0.1, pan=0.12):
    """Random scenes whose objects touch neither each other, the walls nor the camera in any frame.

    size of objects; largest object speed, camera step and camera pan per frame.
    """
    smallest, largest = size
    r = lambda *s: torch.rand(*s, generator=generator, dtype=torch.float64)
    u = lambda a, b, *s: a + (b - a) * r(*s)
    kept = []
    while sum(len(k["size"]) for k in kept) < n:
        m = 4 * n + 64
        t = torch.arange(frames, dtype=torch.float64)
        size = u(smallest, largest, m, objects)
        tall = u(0.3, 0.6, m, objects)                       # half height; spheres use `size`
        kind = torch.randint(0, 3, (m, objects), generator=generator)
        start = u(-ROOM + 0.5, ROOM - 0.5, m, objects, 2)
        velocity = u(-speed, speed, m, objects, 2)
        spin = u(-0.2, 0.2, m, objects)
        where = start[:, None] + velocity[:, None] * t[None, :, None, None]
        angle = u(0, 2 * math.pi, m, objects)[:, None] + spin[:, None] * t[None, :, None]
        side = u(0, 2 * math.pi, m)
        eye = torch.stack([side.cos(), side.sin()], -1) * u(1.6, 2.2, m)[:, None]
        steps = u(-step, step, m, frames, 2)
        steps[:, 0] = 0
        eye = eye[:, None] + steps.cumsum(1)
        turn = u(-pan, pan, m, frames)
        turn[:, 0] = 0
        yaw = (side + math.pi / 2 + u(-0.3, 0.3, m))[:, None] + turn.cumsum(1)   # looks at the room's centre
        pair = (where[:, :, :, None] - where[:, :, None]).norm(dim=-1)
        gap = pair - 1.2 * (size[:, None, :, None] + size[:, None, None, :]) + 9 * torch.eye(objects)
        free = (gap > 0).flatten(1).all(1) & (where.abs() + size[:, None, :, None] < ROOM).flatten(1).all(1)
        free &= ((where - eye[:, :, None]).norm(dim=-1) > size[:, None] + 0.5).flatten(1).all(1)
        free &= (eye.abs() < ROOM - 0.1).flatten(1).all(1)
        look = torch.stack([-yaw.sin(), yaw.cos()], -1)[:, :, None]
        to = where - eye[:, :, None]
        ahead = (to * look).sum(-1) > 0.75 * to.norm(dim=-1)
        free &= (ahead.sum((1, 2)) >= 2 * frames)            # most objects in view
        scene = dict(kind=kind, size=size, tall=tall, where=where, angle=angle, eye=eye, yaw=yaw,
                     colour=u(0, 1, m, objects + 3, 3, 3), pattern=torch.randint(0, 4, (m, objects + 3), generator=generator),
                     period=u(0.12, 0.5, m, objects + 3), phase=u(0, 10, m, objects + 3, 3))
        kept.append({k: v[free] for k, v in scene.items()})
    return {k: torch.cat([s[k] for s in kept])[:n] for k in kept[0]}


def paint(p, surface, scene, smooth=False):
    """Colour of surface points p (N, P, 3) in the surface's own frame; surface (N, P) indexes objects, walls, floor, ceiling."""
    pick = lambda key: scene[key].gather(1, surface) if scene[key].dim() == 2 else \
        scene[key].flatten(2).gather(1, surface[..., None].expand(-1, -1, scene[key].flatten(2).shape[2]))
    colour, period, phase = pick("colour").reshape(*surface.shape, 3, 3), pick("period"), pick("phase")
    q = p / period[..., None] + phase
    noise = torch.sin(q[..., 0] * 1.7 + 2.3 * torch.sin(q[..., 1] * 1.3)) * torch.sin(q[..., 1] * 1.9 + 1.7 * torch.sin(q[..., 2] * 1.1)) \
        * torch.sin(q[..., 2] * 1.5 + 1.9 * torch.sin(q[..., 0] * 0.7))
    if smooth:                                               # octaves of noise: no period, no hard edges
        base, a = p + phase, 0
        for octave in range(4):
            w = base * (1.5 * 2 ** octave) / (0.5 + period[..., None])
            a = a + 0.5 ** octave * torch.sin(w[..., 0] + 1.7 * torch.sin(w[..., 1] + octave)) * torch.sin(1.1 * w[..., 1] + w[..., 2]
                                                                                                    + 1.3 * torch.sin(0.9 * w[..., 2] - w[..., 0]))
        a = (0.5 + 0.6 * a).clamp(0, 1)[..., None]
        return colour[..., 0, :] * a + colour[..., 1, :] * (1 - a)
    checks = (q.floor().sum(-1) % 2)
    stripes = ((q[..., 0] + q[..., 1] + 0.3 * q[..., 2]).floor() % 2)
    dots = (((q - q.floor() - 0.5) ** 2).sum(-1) < 0.2).to(p.dtype)
    a = torch.stack([checks, stripes, dots, (noise > 0).to(p.dtype)], -1).gather(-1, pick("pattern")[..., None])
    base = colour[..., 0, :] * a + colour[..., 1, :] * (1 - a)
    return 0.75 * base + 0.25 * (0.5 + 0.5 * noise[..., None]) * colour[..., 2, :]


def render(scene, frame, height, width, fov=math.pi / 2, samples=2, smooth=False):
    """-> image (N, 3, H, W), depth (N, H, W) Euclidean, label (N, H, W) 0 background else object + 1, pose (N, 6)"""
    s, f64 = samples, torch.float64
    eye, yaw = scene["eye"][:, frame], scene["yaw"][:, frame]
    n = len(eye)
    f = height / 2 / math.tan(fov / 2)
    jj, ii = torch.meshgrid((torch.arange(height * s, dtype=f64) + 0.5) / s - height / 2,
                            (torch.arange(width * s, dtype=f64) + 0.5) / s - width / 2, indexing="ij")
    ray = torch.stack([ii / f, torch.ones_like(ii), -jj / f], -1).reshape(-1, 3)
    ray = ray / ray.norm(dim=-1, keepdim=True)
    c, sn = yaw.cos()[:, None], yaw.sin()[:, None]
    d = torch.stack([c * ray[:, 0] - sn * ray[:, 1], sn * ray[:, 0] + c * ray[:, 1], ray[:, 2].expand(n, -1)], -1)
    o = torch.cat([eye, torch.full((n, 1), EYE, dtype=f64)], 1)[:, None]
    big = torch.tensor(1e9, dtype=f64)
    # room: walls, floor, ceiling
    tx = (torch.sign(d) * ROOM - o)[..., :2] / d[..., :2]
    tz = torch.where(d[..., 2] > 0, (HEIGHT - EYE) / d[..., 2], -EYE / d[..., 2])
    best, wall = torch.minimum(tx.min(-1).values, tz), tx.min(-1).values < tz
    k = scene["size"].shape[1]
    surface = torch.where(wall, k, torch.where(d[..., 2] > 0, k + 2, k + 1))
    local, normal = o + d * best[..., None], torch.zeros_like(d)
    normal[..., 2] = 1.0
    for i in range(k):
        size, tall = scene["size"][:, i, None], scene["tall"][:, i, None]
        ca, sa = scene["angle"][:, frame, i, None].cos(), scene["angle"][:, frame, i, None].sin()
        kind = scene["kind"][:, i, None]
        tall = torch.where(kind == 1, size, tall)
        rel = o[:, 0] - torch.cat([scene["where"][:, frame, i], tall], 1)
        ro = torch.stack([ca[:, 0] * rel[:, 0] + sa[:, 0] * rel[:, 1], -sa[:, 0] * rel[:, 0] + ca[:, 0] * rel[:, 1], rel[:, 2]], -1)[:, None]
        rd = torch.stack([ca * d[..., 0] + sa * d[..., 1], -sa * d[..., 0] + ca * d[..., 1], d[..., 2]], -1)
        half = torch.stack([size * 0.8, size * 0.8, tall], -1)
        t1, t2 = (-half - ro) / rd, (half - ro) / rd
        near, far = torch.minimum(t1, t2).max(-1).values, torch.maximum(t1, t2).min(-1).values
        box = torch.where((near < far) & (near > 0), near, big)
        b, cc = (ro * rd).sum(-1), (ro * ro).sum(-1) - size ** 2
        disc = b * b - cc
        ball = torch.where((disc > 0) & (-b - disc.clamp(min=0).sqrt() > 0), -b - disc.clamp(min=0).sqrt(), big)
        a2 = (rd[..., :2] ** 2).sum(-1)
        b2, c2 = (ro[..., :2] * rd[..., :2]).sum(-1), (ro[..., :2] ** 2).sum(-1) - (0.8 * size) ** 2
        disc2 = b2 * b2 - a2 * c2
        side = (-b2 - disc2.clamp(min=0).sqrt()) / a2
        side = torch.where((disc2 > 0) & (side > 0) & ((ro[..., 2] + side * rd[..., 2]).abs() < tall), side, big)
        cap = torch.minimum(t1[..., 2], t2[..., 2])
        at = ro + cap[..., None] * rd
        cap = torch.where((cap > 0) & ((at[..., :2] ** 2).sum(-1) < (0.8 * size) ** 2), cap, big)
        hit = torch.where(kind == 0, box, torch.where(kind == 1, ball, torch.minimum(side, cap)))
        closer = hit < best
        point = ro + hit.clamp(max=50)[..., None] * rd
        nb = torch.sign(point) * ((point.abs() / half) == (point.abs() / half).max(-1, keepdim=True).values)
        nrm = torch.where((kind == 1)[..., None], point / size[..., None], torch.where((kind == 0)[..., None], nb, point / half))
        best, surface = torch.where(closer, hit, best), torch.where(closer, i, surface)
        local, normal = torch.where(closer[..., None], point, local), torch.where(closer[..., None], nrm, normal)
    light = torch.tensor([0.4, 0.3, 0.85], dtype=f64)
    shade = torch.where(surface < k, 0.65 + 0.35 * (normal * light).sum(-1).clamp(-1, 1), torch.ones_like(best))
    colour = (paint(local, surface, scene, smooth) * shade[..., None]).clamp(0, 1)
    grid = lambda x: x.reshape(n, height * s, width * s, *x.shape[2:])
    image = grid(colour).permute(0, 3, 1, 2)
    image = torch.nn.functional.avg_pool2d(image, s)
    label = torch.where(grid(surface) < k, grid(surface) + 1, 0)[:, s // 2::s, s // 2::s]
    depth = grid(best)[:, s // 2::s, s // 2::s]
    pose = torch.cat([o[:, 0], yaw[:, None], torch.zeros(n, 2, dtype=f64)], 1)
    return image.float(), depth.float(), label, pose.float()


def triplets(n, height, width, seed, frames=3, samples=2, smooth=False, **options):
    """-> images 3 x (n, 3, H, W), poses 3 x (n, 6), depth and label of the middle frame"""
    g = torch.Generator().manual_seed(seed)
    scene = sample_scenes(n, frames, g, **options)
    shots = [render(scene, t, height, width, samples=samples, smooth=smooth) for t in range(3)]
    return [s[0] for s in shots], [s[3] for s in shots], shots[1][1], shots[1][2]
