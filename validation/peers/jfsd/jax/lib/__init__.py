"""The backend that JFSD's tests ask for."""
