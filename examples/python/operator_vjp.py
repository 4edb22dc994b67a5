"""The operator as a function with its vjp, as PyTorch, JAX and their like want it: numpy alone, and one layer for each.

    python3 operator_vjp.py [SCENE.toml] [FOLDER]

A gradient descent on |A softplus(u) - y|^2 finds what glows from a rendered picture, with the exact adjoint of the rays.

As a layer of PyTorch:

    class Camera(torch.autograd.Function):
        @staticmethod
        def forward(context, x):
            y, context.vjp = A.vjp(x.detach().numpy())
            return torch.from_numpy(y)
        @staticmethod
        def backward(context, gradient):
            return torch.from_numpy(context.vjp(gradient.numpy()))

and for JAX:

    @jax.custom_vjp
    def camera(x):
        return jax.pure_callback(A.matvec, jax.ShapeDtypeStruct((A.shape[0],), "float64"), x)
    camera.defvjp(lambda x: (camera(x), None), lambda _, gradient: (jax.pure_callback(
        A.rmatvec, jax.ShapeDtypeStruct((A.shape[1],), "float64"), gradient),))
"""

import pathlib
import sys
from typing import Any, Callable

import numpy
import plenoflame

STEPS = 60
Back = Callable[[Any], Any]
Layer = Callable[[Any], tuple[Any, Back]]


def chain(*layers: Layer) -> Layer:
    """A function of functions that have a vjp, with its own."""
    def composed(x: Any) -> tuple[Any, Back]:
        backs = []
        for layer in layers:
            x, back = layer(x)
            backs.append(back)

        def vjp(gradient: Any) -> Any:
            for back in reversed(backs):
                gradient = back(gradient)
            return gradient
        return x, vjp
    return composed


def softplus(u: Any) -> tuple[Any, Back]:
    """ln(1 + e^u), which is never negative."""
    return numpy.logaddexp(0, u), lambda gradient: gradient / (1 + numpy.exp(-u))


def misfit_to(data: Any) -> Layer:
    """|y - data|^2."""
    return lambda y: (numpy.sum((y - data) ** 2), lambda gradient: 2 * gradient * (y - data))


def main(path: str = "examples/lenslets-30.toml", folder: str = ".") -> None:
    scene = plenoflame.Scene(path)
    picture = scene.render(16)
    operator = scene.operator(unknowns="rings", grid=(8, 12), rays=16)
    data = picture.flux[operator.pixels[:, 1], operator.pixels[:, 0]].astype(float)
    unit = numpy.linalg.norm(data) / numpy.linalg.norm(operator @ numpy.ones(operator.shape[1]))  # W/(m^3 sr)
    scale = numpy.linalg.norm(data)

    def camera(x: Any) -> tuple[Any, Back]:
        y, back = operator.vjp(unit * x)
        return y / scale, lambda gradient: unit * back(gradient / scale)

    loss = chain(softplus, camera, misfit_to(data / scale))
    # Adam's method (Kingma and Ba 2015): any optimiser does.
    u = numpy.zeros(operator.shape[1])
    mean, square = numpy.zeros_like(u), numpy.zeros_like(u)
    losses = []
    for step in range(1, STEPS + 1):
        value, vjp = loss(u)
        losses.append(value)
        gradient = vjp(1.0)
        mean = 0.9 * mean + 0.1 * gradient
        square = 0.999 * square + 0.001 * gradient ** 2
        u -= 0.2 * (mean / (1 - 0.9 ** step)) / (numpy.sqrt(square / (1 - 0.999 ** step)) + 1e-12)
    result = pathlib.Path(folder) / "glow.npz"
    numpy.savez(result, emission=(unit * softplus(u)[0]).reshape(operator.grid_shape), losses=losses)
    print(result.name)


if __name__ == "__main__":
    main(*sys.argv[1:])
