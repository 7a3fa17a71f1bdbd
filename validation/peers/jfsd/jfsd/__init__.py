"""A step of JFSD's tests, by fcm_solve."""
