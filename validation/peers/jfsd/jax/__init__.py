"""As much of jax as JFSD's tests import."""
