"""OPPLE in PyTorch, as docs/model.md describes it: the reference that the shaders are held against.

Plain, slow and differentiable, in float64 where the caller wants it. Parameter names equal those of the
authors' checkpoints. Layout is NCHW; B batch, K object slots, background last.
"""
import math
import re
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional as F

SLOPE = 0.1


@dataclass(frozen=True)
class Config:
    height: int = 128
    width: int = 128
    fov: float = math.pi / 2
    slots: int = 3
    bins: int = 120
    identity: int = 10
    code: int = 64
    depth_width: int = 16      # channels of the depth network's first convolution
    object_width: int = 64     # ... of the object network's
    imagine_width: int = 8     # ... of the imagination network's
    lstm: int = 256
    max_depth: float = 7.2
    max_height: float = 5.0
    beta: float = 1.0
    mask_window: float = 0.0   # how far masks reach around their slot's location; 0: anywhere
    mask_location: bool = False   # objects are at their masks' centroids, and move as those do
    reg: float = 1.0
    smoothness: float = 0.0    # factors of two more terms
    pose_contrast: float = 0.0
    warp: bool = True          # False: the no-warping ablation
    relaxed: bool = False      # True: learned motion
    orientation: str = "yaw"   # or "euler": three angles for each object
    pose_loss: str = "kl"      # or "js"
    statistics_frames: str = "all"   # or "second": frames 1 and 3 pass neither depth network nor mask decoder
    dropout: tuple = (0.05, 0.05, 0.0005)   # depth, object, imagination network

    @property
    def orientation_numbers(self):
        return 6 if self.orientation == "euler" else self.bins


PRESETS = {
    "full": Config(),
    "small": Config(height=64, width=64, depth_width=8, object_width=16, imagine_width=4, lstm=128),
    "tiny": Config(height=32, width=32, depth_width=4, object_width=8, imagine_width=2, lstm=16),
}


# ---- blocks ---------------------------------------------------------------------------------------------

def block(conv, norm, drop):
    """conv -> LeakyReLU -> [norm] -> dropout, indexed as the authors' checkpoints index them."""
    layers = [conv, nn.LeakyReLU(SLOPE)] + ([norm] if norm is not None else []) + [nn.Dropout(drop)]
    return nn.Sequential(*layers)


class LayerNormCHW(nn.Module):
    def forward(self, x):
        return F.layer_norm(x, x.shape[1:], eps=0.01)


def batch_norm(eps):
    return lambda channels: nn.BatchNorm2d(channels, eps=eps)


class InConv(nn.Module):
    def __init__(self, cin, cout):
        super().__init__()
        self.conv = nn.Sequential(nn.Conv2d(cin, cout, 3, padding=1), nn.LeakyReLU(SLOPE))

    def forward(self, x):
        return self.conv(x)


class OutConv(nn.Module):
    def __init__(self, cin, cout):
        super().__init__()
        self.conv = nn.Conv2d(cin, cout, 3, padding=1)

    def forward(self, x):
        return self.conv(x)


class Down(nn.Module):
    def __init__(self, cin, cout, norm, drop):
        super().__init__()
        self.conv = block(nn.Conv2d(cin, cin, 3, padding=1), norm(cin) if norm else None, drop)
        self.down = block(nn.Conv2d(cin, cout, 3, stride=2, padding=1), norm(cout) if norm else None, drop)

    def forward(self, x):
        return self.down(self.conv(x) + x)


class Up(nn.Module):
    """Transposed convolution, crop to the size of the same level on the way down, [concatenate that], convolution."""

    def __init__(self, cin, cout, norm, drop, kernel=3, skip=True, residual=False):
        super().__init__()
        pad = dict(padding=1, output_padding=1) if kernel == 3 else {}
        self.up = block(nn.ConvTranspose2d(cin, cout, kernel, stride=2, **pad), norm(cout) if norm else None, drop)
        self.conv = block(nn.Conv2d(cout * (2 if skip else 1), cout, 3, padding=1), norm(cout) if norm else None, drop)
        self.skip, self.residual = skip, residual

    def forward(self, x, level):
        u = self.up(x)
        dy, dx = u.shape[2] - level.shape[2], u.shape[3] - level.shape[3]
        u = u[:, :, dy // 2:u.shape[2] - (dy - dy // 2), dx // 2:u.shape[3] - (dx - dx // 2)]
        out = self.conv(torch.cat([level, u], 1) if self.skip else u)
        return out + u if self.residual else out


class Aspp(nn.Module):
    def __init__(self, c, drop):
        super().__init__()

        def branch(kernel, dilation):
            conv = nn.Conv2d(c, c, kernel, padding=0 if kernel == 1 else dilation, dilation=dilation, bias=False)
            return nn.Sequential(conv, nn.LeakyReLU(SLOPE), nn.BatchNorm2d(c))
        self.aspp1, self.aspp2, self.aspp3, self.aspp4 = branch(1, 1), branch(3, 6), branch(3, 12), branch(3, 18)
        self.avg_pool = nn.Sequential(nn.AdaptiveAvgPool2d((4, 4)), nn.Conv2d(c, c, 1, bias=False),
                                      nn.BatchNorm2d(c), nn.LeakyReLU(SLOPE))
        self.conv1, self.bn1 = nn.Conv2d(5 * c, c, 1, bias=False), nn.BatchNorm2d(c)
        self.dropout = nn.Dropout(drop)

    def forward(self, x):
        pooled = F.interpolate(self.avg_pool(x), size=x.shape[2:], mode="bilinear", align_corners=True)
        y = torch.cat([self.aspp1(x), self.aspp2(x), self.aspp3(x), self.aspp4(x), pooled], 1)
        return self.dropout(F.leaky_relu(self.bn1(self.conv1(y)), SLOPE))


# ---- the three networks ---------------------------------------------------------------------------------

class DepthNet(nn.Module):
    def __init__(self, cfg):
        super().__init__()
        w, bn, drop = cfg.depth_width, batch_norm(0.01), cfg.dropout[0]
        c = [w, 2 * w, 4 * w, 8 * w, 16 * w, 16 * w, 16 * w]
        self.inc = InConv(3, c[0])
        for i in range(6):
            setattr(self, f"down{i + 1}", Down(c[i], c[i + 1], bn if i < 5 else None, drop))
            setattr(self, f"up{i + 1}", Up(c[6 - i], c[5 - i], bn if i > 0 else None, drop, kernel=2, residual=True))
        self.outc = OutConv(c[0], 1)

    def forward(self, image):
        skips = [self.inc(image)]
        for i in range(6):
            skips.append(getattr(self, f"down{i + 1}")(skips[-1]))
        x = skips.pop()
        for i in range(6):
            x = getattr(self, f"up{i + 1}")(x, skips.pop())
        return self.outc(x)


class ObjectNet(nn.Module):
    """Encoder, slot LSTM and mask decoder; `rnn`, `lin` and `up1_att_lin` keep the checkpoint's names."""

    def __init__(self, cfg):
        super().__init__()
        w, enc, dec, drop = cfg.object_width, batch_norm(1e-6), batch_norm(0.01), cfg.dropout[1]
        self.cfg = cfg
        c = [w, w, w, 2 * w, 2 * w, 4 * w, 4 * w, 4 * w]
        self.inc = InConv(3, c[0])
        for i in range(7):
            setattr(self, f"down{i + 1}", Down(c[i], c[i + 1], enc, drop))
            setattr(self, f"up{i}_att", Up(c[7 - i], c[6 - i], dec, drop))
        self.assp = Aspp(c[3], drop)
        h, v = cfg.height, cfg.width
        for _ in range(7):
            h, v = (h + 1) // 2, (v + 1) // 2
        features = c[7] * h * v
        self.rnn = nn.LSTM(features, cfg.lstm, 1, batch_first=True)
        self.lin = nn.Sequential(nn.LeakyReLU(SLOPE), nn.Linear(cfg.lstm, 3 + cfg.orientation_numbers + cfg.code))
        self.up1_att_lin = nn.Sequential(nn.Linear(cfg.code, features), nn.LeakyReLU(SLOPE))
        self.outc_att = OutConv(w, 1)

    def forward(self, image, masks=True):
        """-> raw slot vectors (B, K, 3 + orientation + code), mask logits (B, K, H, W) or None"""
        skips = [self.inc(image)]
        for i in range(7):
            x = self.assp(skips[-1]) if i == 3 else skips[-1]
            skips.append(getattr(self, f"down{i + 1}")(x))
        top = skips.pop()
        sequence = top.flatten(1)[:, None].expand(-1, self.cfg.slots, -1)
        raw = self.lin(self.rnn(sequence)[0])
        if not masks:
            return raw, None
        logits = []
        for k in range(self.cfg.slots):
            x = self.up1_att_lin(raw[:, k, 3 + self.cfg.orientation_numbers:]).reshape(top.shape)
            for i in range(7):
                x = getattr(self, f"up{i}_att")(x, skips[6 - i])
            logits.append(self.outc_att(x))
        return raw, torch.cat(logits, 1)


class ImaginationNet(nn.Module):
    def __init__(self, cfg):
        super().__init__()
        w, drop = cfg.imagine_width, cfg.dropout[2]
        c = [w, 2 * w, 4 * w, 8 * w, 16 * w, 32 * w, 64 * w]
        layer_norm = lambda channels: LayerNormCHW()
        self.inc = InConv(4, c[0])
        for i in range(6):
            setattr(self, f"down{i + 1}", Down(c[i], c[i + 1], layer_norm if i < 5 else None, drop))
            setattr(self, f"up{i + 1}", Up(c[6 - i], c[5 - i], layer_norm, drop, skip=i < 3))
        h, v = cfg.height, cfg.width
        for _ in range(6):
            h, v = (h + 1) // 2, (v + 1) // 2
        self.linear = nn.Linear(12 if cfg.orientation == "euler" else 7, c[6] * h * v)
        self.outc = OutConv(c[0], 5)

    def forward(self, x, condition):
        skips = [self.inc(x)]
        for i in range(6):
            skips.append(getattr(self, f"down{i + 1}")(skips[-1]))
        x = skips.pop()
        x = x + self.linear(condition).reshape(x.shape)
        for i in range(6):
            x = getattr(self, f"up{i + 1}")(x, skips.pop())
        return self.outc(x)


# ---- geometry -------------------------------------------------------------------------------------------

def euler(cosine, sine):
    """(..., 3) of yaw, pitch and roll -> (..., 3, 3): Rz(yaw) Rx(pitch) Ry(roll)"""
    c, s = cosine.unbind(-1), sine.unbind(-1)
    o, l = torch.zeros_like(c[0]), torch.ones_like(c[0])
    mat = lambda rows: torch.stack([torch.stack(r, -1) for r in rows], -2)
    rz = mat([[c[0], -s[0], o], [s[0], c[0], o], [o, o, l]])
    rx = mat([[l, o, o], [o, c[1], -s[1]], [o, s[1], c[1]]])
    ry = mat([[c[2], o, s[2]], [o, l, o], [-s[2], o, c[2]]])
    return rz @ rx @ ry


def nearest_rotation(m):
    """the rotation R with the largest trace of R^T M, by Newton's iteration for the polar decomposition, whose gradient is
    exact where that of singular vectors is not (equal singular values)"""
    if not (torch.linalg.det(m) > 0).all():
        raise ValueError("a mean of rotations has no positive determinant: its nearest rotation takes singular vectors")
    for _ in range(30):
        m = (m + torch.linalg.inv(m).transpose(-1, -2)) / 2
    return m


def turn_vector(r):
    """axis of a rotation, as long as its angle, which must be neither 0 nor pi"""
    sine = torch.stack([r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]], -1) / 2
    size = sine.norm(dim=-1, keepdim=True)
    return sine / size * torch.atan2(size, (r.diagonal(dim1=-2, dim2=-1).sum(-1, keepdim=True) - 1) / 2)


def turn_matrix(v):
    """the other way round"""
    o = torch.zeros_like(v[..., 0])
    x, y, z = v.unbind(-1)
    return torch.matrix_exp(torch.stack([torch.stack(r, -1) for r in [[o, -z, y], [z, o, -x], [-y, x, o]]], -2))


def camera_to_world(pose):
    """pose (B, 6): x, y, z, yaw, pitch, roll -> (B, 4, 4)"""
    angles = pose[:, 3:]
    top = torch.cat([euler(angles.cos(), angles.sin()), pose[:, :3, None]], 2)
    return torch.cat([top, torch.tensor([0., 0, 0, 1], dtype=pose.dtype).expand(len(pose), 1, 4)], 1)


def relative(pose_a, pose_b):
    """map (B, 4, 4) of a static point from camera a to camera b"""
    return torch.linalg.inv(camera_to_world(pose_b)) @ camera_to_world(pose_a)


def ego_motion(pose_a, pose_b):
    """(v_x, v_y, omega) of the camera, in camera a's heading"""
    c, s = pose_a[:, 3].cos(), pose_a[:, 3].sin()
    d = pose_b[:, :2] - pose_a[:, :2]
    omega = torch.remainder(pose_b[:, 3] - pose_a[:, 3] + math.pi, 2 * math.pi) - math.pi
    return torch.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1], omega], 1)


def spatial_ego_motion(pose_a, pose_b):
    """translation and turn vector of the camera, in camera a's frame (B, 6)"""
    step = torch.linalg.inv(camera_to_world(pose_a)) @ camera_to_world(pose_b)
    return torch.cat([step[:, :3, 3], turn_vector(step[:, :3, :3])], 1)


def pixel_grid(cfg, dtype):
    j, i = torch.meshgrid(torch.arange(cfg.height, dtype=dtype) - (cfg.height - 1) / 2,
                          torch.arange(cfg.width, dtype=dtype) - (cfg.width - 1) / 2, indexing="ij")
    return i, j


def focal(cfg):
    return cfg.height / 2 / math.tan(cfg.fov / 2)


def back_project(cfg, depth):
    """Euclidean depth (B, H, W) -> points (B, 3, H, W)"""
    i, j = pixel_grid(cfg, depth.dtype)
    ray = torch.stack([i / focal(cfg), torch.ones_like(i), -j / focal(cfg)])
    return depth[:, None] * ray / ray.norm(dim=0)


def project(cfg, p):
    """points (..., 3, H, W) -> image u, v from the centre and signed distance"""
    x, y, z = p.unbind(-3)
    scale = focal(cfg) / (y.abs() + 1e-5)
    return x * scale, -z * scale, p.norm(dim=-3) * torch.sign(y + 1e-5)


# ---- objects --------------------------------------------------------------------------------------------

def decode(cfg, raw):
    """raw slot vectors -> dict of location (B, K, 3), log_pose (B, K, bins) or rotation (B, K, 3, 3), code (B, K, code)"""
    theta = cfg.fov / 2 * 1.2 * (2 * torch.sigmoid(raw[..., 0]) - 1)
    rho = cfg.max_depth * torch.sigmoid(raw[..., 1])
    z = cfg.max_height * (2 * torch.sigmoid(raw[..., 2]) - 1)
    location = torch.stack([rho * theta.sin(), rho * theta.cos(), z], -1)
    numbers, code = raw[..., 3:3 + cfg.orientation_numbers], raw[..., 3 + cfg.orientation_numbers:]
    if cfg.orientation == "euler":
        pairs = F.normalize(numbers.unflatten(-1, (3, 2)), dim=-1)
        return dict(location=location, rotation=euler(pairs[..., 0], pairs[..., 1]), code=code)
    return dict(location=location, log_pose=F.log_softmax(numbers, -1), code=code)


def match(cfg, code_a, code_b):
    """how far each object of b (rows) is each object of a: log weights (B, K, K), score q (B, K)"""
    a = F.pad(code_a[..., :cfg.identity], (0, 0, 0, 1))
    b = F.pad(code_b[..., :cfg.identity], (0, 0, 0, 1))
    s = -((b[:, :, None] - a[:, None]) ** 2).sum(-1)
    q = F.softmax(s, 2)[:, :-1, :-1].sum(2)
    return F.log_softmax(s[:, :-1, :-1], 2), q


def align(log_w, seen):
    """location and orientation of `seen` in the order of log_w's rows"""
    aligned = dict(location=log_w.exp() @ seen["location"])
    if "rotation" in seen:
        return dict(aligned, rotation=torch.einsum("bkl,blij->bkij", log_w.exp(), seen["rotation"]))
    pose = torch.logsumexp(log_w[..., None] + seen["log_pose"][:, None], 2)
    return dict(aligned, log_pose=F.log_softmax(pose, -1))


class PoseResampling(nn.Module):
    """T(a) for whole degrees a in [-180, 180] and the prior over rotations, built in float64. The inverse of K_0 loses all
    digits towards 170 bins (its condition grows about as e^(bins^2 / 800)); up to some 120 it is exact enough to compare with."""

    def __init__(self, bins, kappa=100.0, prior_kappa=0.2):
        super().__init__()
        theta = torch.arange(bins, dtype=torch.float64) * (2 * math.pi / bins)
        diff = theta[(torch.arange(bins)[None] - torch.arange(bins)[:, None]) % bins]
        density = lambda x, k: torch.exp(k * (x.cos() - 1)) / (2 * math.pi * torch.special.i0e(torch.tensor(k, dtype=torch.float64)))
        degrees = torch.arange(-180, 181, dtype=torch.float64) * math.pi / 180
        inverse = torch.linalg.inv(density(diff, kappa))
        # plain attributes: module.to(float32) must not touch the float64 build
        self.table = density(diff[None] + degrees[:, None, None], kappa) @ inverse
        prior = torch.log(density(diff, prior_kappa))
        self.log_prior = prior - torch.logsumexp(prior.flatten(), 0)
        self.shift = (torch.arange(bins)[None] - torch.arange(bins)[:, None]) % bins   # [m, n] -> n - m
        self.unit = torch.stack([theta.cos(), theta.sin()], 1)

    def resample(self, log_p, angle):
        """log_p (B, K, bins), angle (B,) radians -> log_softmax(T(angle) log_p)"""
        index = torch.round(angle * (180 / math.pi)).long() + 180
        t = self.table[index].to(log_p.dtype)
        return F.log_softmax((t[:, None] @ log_p[..., None])[..., 0], -1)

    def rotation(self, log_p1, log_p2):
        """log posterior over the rotation between two poses (B, K, bins) and its mean direction (B, K, 2)"""
        joint = log_p1[..., :, None] + log_p2[..., None, :] + self.log_prior.to(log_p1.dtype)
        joint = joint - torch.logsumexp(joint, (2, 3), keepdim=True)
        m = torch.arange(joint.shape[-1])
        by_shift = joint[:, :, m[:, None], (m[:, None] + m[None]) % len(m)]            # [m, gamma]
        log_g = torch.logsumexp(by_shift, 2)
        e = log_g.exp() @ self.unit.to(log_p1.dtype) + torch.tensor([1e-8, 0], dtype=log_p1.dtype)
        return log_g, (e / e.norm(dim=-1, keepdim=True)).clamp(-1, 1)

    def rotate(self, log_p, log_g):
        """circular convolution of two distributions in the log domain"""
        m = torch.arange(log_p.shape[-1])
        return torch.logsumexp(log_p[..., None, :] + log_g[..., (m[:, None] - m[None]) % len(m)], -1)


class Mlp(nn.Module):
    def __init__(self, *widths):
        super().__init__()
        self.layers = nn.ModuleList(nn.Linear(a, b) for a, b in zip(widths, widths[1:]))

    def forward(self, x):
        for layer in self.layers[:-1]:
            x = F.gelu(layer(x))
        return self.layers[-1](x)


# ---- splatting ------------------------------------------------------------------------------------------

def splat(cfg, image, points, weight):
    """Forward-splat every pixel of `image` (B, 3, H, W) to its hypotheses.

    points (B, S, 3, H, W) in the target camera, weight (B, S, H, W).
    -> image (B, 3, H, W), depth (B, H, W), total weight (B, H, W)
    """
    h, w = cfg.height, cfg.width
    u, v, d = project(cfg, points)
    valid = (d > 1e-5).to(d.dtype)
    nearness = torch.where(d > 0, torch.exp(-cfg.beta * d * valid) * valid, torch.zeros_like(d))
    x, y = u + (w + 1) / 2, v + (h + 1) / 2            # in the grid with a border ring
    x0, y0 = x.detach().floor(), y.detach().floor()
    source = torch.cat([image[:, None].expand(-1, d.shape[1], -1, -1, -1), d[:, :, None]], 2)
    ring = (h + 2) * (w + 2)
    total = image.new_zeros(len(image), ring)
    denominator = image.new_zeros(len(image), ring)
    numerator = image.new_zeros(len(image), 4, ring)
    for dy in (0, 1):
        for dx in (0, 1):
            cx, cy = (x0 + dx).clamp(0, w + 1), (y0 + dy).clamp(0, h + 1)
            share = (1 - (x - x0 - dx).abs()) * (1 - (y - y0 - dy).abs())
            a = share * weight
            target = (cy * (w + 2) + cx).long().flatten(1)
            total = total.scatter_add(1, target, (a * valid).flatten(1))
            denominator = denominator.scatter_add(1, target, (a * nearness).flatten(1))
            values = ((a * nearness)[:, :, None] * source).transpose(1, 2).flatten(2)
            numerator = numerator.scatter_add(2, target[:, None].expand(-1, 4, -1), values)
    out = (numerator / (denominator + 1e-22)[:, None]).reshape(-1, 4, h + 2, w + 2)[:, :, 1:-1, 1:-1]
    return out[:, :3], out[:, 3], total.reshape(-1, h + 2, w + 2)[:, 1:-1, 1:-1]


def mask_centroid(masks, points):
    """(B, K, 3), where objects' masks are: the last of `masks` (B, K+1, H, W) is background"""
    objects = masks[:, :-1]
    return torch.einsum("bkhw,bchw->bkc", objects, points) / (objects.sum((2, 3)) + 1e-22)[..., None]


# ---- the whole ------------------------------------------------------------------------------------------

class Opple(nn.Module):
    def __init__(self, cfg=Config()):
        super().__init__()
        self.cfg = cfg
        self.depth_net, self.object_net, self.imagine_net = DepthNet(cfg), ObjectNet(cfg), ImaginationNet(cfg)
        self.pose = PoseResampling(cfg.bins)
        if cfg.relaxed:
            self.move_location = Mlp(6, 16, 16, 3)
            self.move_object_pixel = Mlp(18, 64, 64, 32, 4)
            self.move_background_pixel = Mlp(18, 64, 64, 32, 4)

    def perceive(self, image):
        """What one image shows: dict of depth, masks, location, log_pose, code."""
        depth = self.cfg.max_depth * torch.sigmoid(self.depth_net(image)[:, 0])
        state = self.objects(image, depth=depth)
        return {"depth": depth, **state, "location": state["place"]}

    def objects(self, image, masks=True, depth=None):
        raw, logits = self.object_net(image, masks)
        state = decode(self.cfg, raw)
        if not masks:
            return dict(state, place=state["location"])
        points = back_project(self.cfg, depth) if self.cfg.mask_window > 0 or self.cfg.mask_location else None
        if self.cfg.mask_window > 0:
            away = points[:, None] - state["location"][..., None, None]
            logits = logits - away.square().sum(2) / (2 * self.cfg.mask_window ** 2)
        masks = F.softmax(F.pad(logits, (0, 0, 0, 0, 0, 1)), 1)
        place = mask_centroid(masks, points) if self.cfg.mask_location else state["location"]
        return dict(state, place=place, masks=masks, mask_logits=logits)

    def forward(self, images, poses):
        """images 3 x (B, 3, H, W) in [0, 1]; poses 3 x (B, 6) -> dict of every named stage"""
        cfg = self.cfg
        seen = [frame == 1 or cfg.statistics_frames == "all" or (frame == 0 and cfg.mask_location) for frame in range(3)]
        depths = [cfg.max_depth * torch.sigmoid(self.depth_net(image)[:, 0]) if s else None for image, s in zip(images, seen)]
        depth = depths[1]
        o1, o2, o3 = (self.objects(*frame) for frame in zip(images, seen, depths))
        m12, m23 = relative(poses[0], poses[1]), relative(poses[1], poses[2])
        ego12, ego23 = ego_motion(poses[0], poses[1]), ego_motion(poses[1], poses[2])

        log_w12, q12 = match(cfg, o1["code"], o2["code"])
        o1_aligned, place2 = align(log_w12, dict(o1, location=o1["place"])), o2["place"]
        spatial = cfg.orientation == "euler"
        apply = lambda m, x: x @ m[:, :3, :3].transpose(1, 2) + m[:, None, :3, 3]
        carry = lambda m, ego, x: apply(m, x)
        if cfg.relaxed:
            carry = lambda m, ego, x: x + self.move_location(torch.cat([ego[:, None].expand(-1, x.shape[1], -1), x], 2))
        velocity = (place2 - carry(m12, ego12, o1_aligned["location"])) * q12[..., None]
        location3 = carry(m23, ego23, place2 + velocity)

        points2 = back_project(cfg, depth)
        if spatial:
            turned = self.turn_in_space(m12, m23, o1_aligned["rotation"], o2["rotation"], q12)
            ego = spatial_ego_motion(poses[1], poses[2])
            motion = F.pad(torch.cat([velocity, turned["turn_vector"]], 2), (0, 0, 0, 1))    # (B, K+1, 6)
        else:
            turned = self.turn_in_the_plane(ego12, ego23, o1_aligned["log_pose"], o2["log_pose"], q12)
            ego = ego23
            still = points2.new_tensor([0, 0, 0, 1, 0]).expand(len(depth), 1, 5)
            motion = torch.cat([torch.cat([velocity, turned["direction"]], 2), still], 1)    # (B, K+1, 5)
        if spatial:
            points3 = self.rigid_pixels(points2, m23, place2, velocity, turn_matrix(turned["turn_vector"]))
        elif cfg.relaxed:
            points3 = self.move_pixels(points2, ego23, place2, location3, motion)
        else:
            angles = F.pad(turned["omega"][..., None], (0, 2))
            points3 = self.rigid_pixels(points2, m23, place2, velocity, euler(angles.cos(), angles.sin()))
        warped, warped_depth, total = splat(cfg, images[1], points3, o2["masks"])
        share = 0.99 * total.clamp(0, 1) * (1.0 if cfg.warp else 0.0)

        imagined, imagined_depth = self.imagine(images[1], depth, o2["masks"], ego, motion)
        predicted = share[:, None] * warped + (1 - share[:, None]) * imagined
        predicted_depth = share * warped_depth + (1 - share) * imagined_depth
        return dict(o1=o1, o2=o2, o3=o3, depth=depth, points2=points2, points3=points3, q12=q12, velocity=velocity,
                    location3=location3, **turned, warped=warped, warped_depth=warped_depth, share=share, imagined=imagined, imagined_depth=imagined_depth,
                    predicted=predicted, predicted_depth=predicted_depth)

    def turn_in_the_plane(self, ego12, ego23, log_pose1, log_pose2, q12):
        seen1 = self.pose.resample(log_pose1, -ego12[:, 2])
        log_g, direction = self.pose.rotation(seen1, log_pose2)
        omega = torch.atan2(direction[..., 1], direction[..., 0]) * (q12 + 1e-8)
        log_pose3 = self.pose.resample(self.pose.rotate(log_pose2, log_g), -ego23[:, 2])
        return dict(omega=omega, direction=direction, log_pose3=log_pose3)

    def turn_in_space(self, m12, m23, rotation1, rotation2, q12):
        expected = nearest_rotation(rotation2 @ (m12[:, None, :3, :3] @ rotation1).transpose(-1, -2))
        vector = turn_vector(expected) * q12[..., None]
        return dict(turn_vector=vector, rotation3=m23[:, None, :3, :3] @ turn_matrix(vector) @ rotation2)

    def rigid_pixels(self, points, m23, location, velocity, turn):
        flat = points.flatten(2)[:, None]                                                # (B, 1, 3, HW)
        moved = turn @ (flat - location[..., None]) + (location + velocity)[..., None]
        every = torch.cat([moved, flat], 1)
        every = m23[:, None, :3, :3] @ every + m23[:, None, :3, 3:]
        return every.reshape(*every.shape[:3], *points.shape[2:])

    def move_pixels(self, points, ego, location2, location3, motion):
        b, _, h, w = points.shape
        pixel = F.pad(points, (0, 0, 0, 0, 0, 1), value=1.0).permute(0, 2, 3, 1)           # (B, H, W, 4)
        none = torch.zeros_like(location2[:, :1])
        where = torch.cat([torch.cat([location2, none], 1), torch.cat([location3, none], 1)], 2)
        out = []
        for k in range(motion.shape[1]):
            aux = torch.cat([ego, where[:, k], motion[:, k]], 1)[:, None, None].expand(-1, h, w, -1)
            net = self.move_object_pixel if k < motion.shape[1] - 1 else self.move_background_pixel
            out.append((pixel + net(torch.cat([aux, pixel], 3)))[..., :3].permute(0, 3, 1, 2))
        return torch.stack(out, 1)

    def imagine(self, image, depth, masks, ego, motion):
        log_depth = torch.log(depth + 1e-5)
        told = lambda m: m if self.cfg.orientation == "euler" else m[:, [0, 1, 3, 4]]
        logits = []
        for k in range(masks.shape[1]):
            x = torch.cat([image, log_depth[:, None]], 1) * masks[:, k:k + 1]
            logits.append(self.imagine_net(x, torch.cat([ego, told(motion[:, k])], 1)))
        y = torch.stack(logits, 1)                                                       # (B, K+1, 5, H, W)
        weight = F.softmax(y[:, :, 4], 1)
        depth = self.cfg.max_depth * torch.sigmoid(y[:, :, 3]) + 1e-5
        return (weight[:, :, None] * torch.sigmoid(y[:, :, :3])).sum(1), (weight * depth).sum(1)


def losses(cfg, out, image3, permutation):
    """dict of the named terms and `total`; permutation (B,) pairs scenes for the collapse term"""
    o1, o2, o3 = out["o1"], out["o2"], out["o3"]
    log_w23, q23 = match(cfg, o2["code"], o3["code"])
    predicted = align(log_w23, {k: out[k + "3"] for k in ("location", "log_pose", "rotation") if k + "3" in out})
    centre = mask_centroid(o2["masks"], out["points2"])
    terms = dict(image=((out["predicted"] - image3) ** 2).sum((1, 2, 3)).mean(),
                 centre=((centre - o2["location"]) ** 2).mean(),
                 location=(((predicted["location"] - o3["location"]) ** 2).sum(2) * q23).sum(1).mean(),
                 pose=(divergence(cfg, o3, predicted) * q23).sum(1).mean(),
                 collapse=-((o1["location"][permutation] - o3["location"]).abs().sum(2).clamp(max=1) * q23).sum(1).mean())
    factor = dict(dict.fromkeys(terms, cfg.reg), image=1)
    if cfg.smoothness:
        steps = [o2["masks"].diff(dim=axis) for axis in (2, 3)]
        terms["smoothness"] = sum((s ** 2).sum() for s in steps) / len(image3)
        factor["smoothness"] = cfg.reg * cfg.smoothness
    if cfg.pose_contrast:
        other = dict(log_pose=o1["log_pose"][permutation])
        terms["pose_contrast"] = -(divergence(cfg, o3, other).clamp(max=2) * q23).sum(1).mean()
        factor["pose_contrast"] = cfg.reg * cfg.pose_contrast
    return dict(terms, total=sum(factor[k] * v for k, v in terms.items()))


def divergence(cfg, seen, predicted):
    """how far two orientations are from each other (B, K)"""
    if cfg.orientation == "euler":
        return 0.5 * ((seen["rotation"] - predicted["rotation"]) ** 2).sum((-1, -2))
    log_p, log_q = seen["log_pose"], predicted["log_pose"]
    kl = lambda a, b: (a.exp() * (a - b)).sum(-1)
    if cfg.pose_loss == "js":
        log_m = torch.logaddexp(log_p, log_q) - math.log(2)
        return 0.5 * (kl(log_p, log_m) + kl(log_q, log_m))
    return 0.5 * (kl(log_p, log_q) + kl(log_q, log_p))


def adam(model):
    """docs/model.md section 7. One optimiser serves all networks: their settings are the same."""
    return torch.optim.Adam(model.parameters(), 3e-4, eps=1e-6)


def clip_gradients(model):
    """By value, more loosely in the depth network (docs/model.md section 7)."""
    for name, p in model.named_parameters():
        limit = 2.5 if name.startswith("depth_net") else 1.0
        p.grad.clamp_(-limit, limit)


AUTHORS = [(r"^depth_net\.", "depth_model.depth_net."), (r"^object_net\.", "segmentation_model.seg_net.seg_net."),
           (r"^imagine_net\.", "imagination_model.imag_net.imag_net."), (r"^move_location\.", "warping_model.warpnet1."),
           (r"^move_object_pixel\.", "warping_model.warpnet2."), (r"^move_background_pixel\.", "warping_model.warpnet2_bground."),
           (r"(warpnet1)\.layers\.(\d)", lambda m: f"{m[1]}.fc{int(m[2]) + 1}"),
           (r"(warpnet2\w*)\.layers\.(\d)", lambda m: f"{m[1]}.conv{int(m[2]) + 1}")]


def authors_name(name):
    """The checkpoint's name of one of this module's parameters or buffers. (A checkpoint's warpnet2 weights are 1x1
    convolutions: they have two more dimensions of size 1.)"""
    for pattern, theirs in AUTHORS:
        name = re.sub(pattern, theirs, name)
    return name
