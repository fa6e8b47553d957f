! Contacts among discs and spheres, decided exactly: the Fortran interface to contactbench.h, which
! documents each call. Particles are numbered from 0; x has the shape (dim, n).
module contactbench
    use, intrinsic :: iso_c_binding
    implicit none

    integer(c_int), parameter :: contactbench_ok = 0
    integer(c_int), parameter :: contactbench_invalid = 1
    integer(c_int), parameter :: contactbench_memory = 2
    integer(c_int), parameter :: contactbench_defect = 3

    type, bind(c) :: contactbench_box
        ! A vector is a column.
        real(c_double) :: vectors(3, 3) = 0.0_c_double
        integer(c_int) :: periodic(3) = 0
        real(c_double) :: origin(3) = 0.0_c_double
    end type

    type, bind(c) :: contactbench_scene
        integer(c_size_t) :: n = 0
        integer(c_int) :: dim = 3
        type(c_ptr) :: x = c_null_ptr
        integer(c_size_t) :: radii = 0
        type(c_ptr) :: r = c_null_ptr
        type(c_ptr) :: bounds = c_null_ptr
    end type

    type, bind(c) :: contactbench_errors
        integer(c_int64_t) :: contacts = 0, missed = 0, spurious = 0, duplicate = 0, self_pairs = 0
        real(c_double) :: deepest_miss = 0.0_c_double, widest_false = 0.0_c_double
    end type

    interface
        function contactbench_last_error() bind(c)
            import :: c_ptr
            type(c_ptr) :: contactbench_last_error
        end function

        ! Names end with c_null_char.
        function contactbench_new(detector, arithmetic, threads, memory_limit, made) bind(c)
            import :: c_int, c_char, c_size_t, c_int64_t, c_ptr
            character(kind=c_char), intent(in) :: detector(*), arithmetic(*)
            integer(c_size_t), value :: threads
            integer(c_int64_t), value :: memory_limit
            type(c_ptr), intent(out) :: made
            integer(c_int) :: contactbench_new
        end function

        subroutine contactbench_free(detector) bind(c)
            import :: c_ptr
            type(c_ptr), value :: detector
        end subroutine

        function contactbench_contacts(detector, scene) bind(c)
            import :: c_int, c_ptr, contactbench_scene
            type(c_ptr), value :: detector
            type(contactbench_scene), intent(in) :: scene
            integer(c_int) :: contactbench_contacts
        end function

        function contactbench_count(detector) bind(c)
            import :: c_size_t, c_ptr
            type(c_ptr), value :: detector
            integer(c_size_t) :: contactbench_count
        end function

        ! For c_f_pointer, with the shape (2, count).
        function contactbench_pairs(detector) bind(c)
            import :: c_ptr
            type(c_ptr), value :: detector
            type(c_ptr) :: contactbench_pairs
        end function

        ! For c_f_pointer, with the shape (dim, count).
        function contactbench_images(detector) bind(c)
            import :: c_ptr
            type(c_ptr), value :: detector
            type(c_ptr) :: contactbench_images
        end function

        function contactbench_verify(scene, arithmetic, count, pairs, images, errors) bind(c)
            import :: c_int, c_char, c_size_t, c_int32_t, c_ptr
            import :: contactbench_scene, contactbench_errors
            type(contactbench_scene), intent(in) :: scene
            character(kind=c_char), intent(in) :: arithmetic(*)
            integer(c_size_t), value :: count
            integer(c_int32_t), intent(in) :: pairs(*)
            type(c_ptr), value :: images
            type(contactbench_errors), intent(out) :: errors
            integer(c_int) :: contactbench_verify
        end function

        function contactbench_tracker_new(tracker, arithmetic, threads, memory_limit, made) bind(c)
            import :: c_int, c_char, c_size_t, c_int64_t, c_ptr
            character(kind=c_char), intent(in) :: tracker(*), arithmetic(*)
            integer(c_size_t), value :: threads
            integer(c_int64_t), value :: memory_limit
            type(c_ptr), intent(out) :: made
            integer(c_int) :: contactbench_tracker_new
        end function

        subroutine contactbench_tracker_free(tracker) bind(c)
            import :: c_ptr
            type(c_ptr), value :: tracker
        end subroutine

        function contactbench_tracker_step(tracker, scene) bind(c)
            import :: c_int, c_ptr, contactbench_scene
            type(c_ptr), value :: tracker
            type(contactbench_scene), intent(in) :: scene
            integer(c_int) :: contactbench_tracker_step
        end function

        function contactbench_tracker_forget(tracker) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: tracker
            integer(c_int) :: contactbench_tracker_forget
        end function

        function contactbench_tracker_built(tracker) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: tracker
            integer(c_int) :: contactbench_tracker_built
        end function

        function contactbench_tracker_count(tracker) bind(c)
            import :: c_size_t, c_ptr
            type(c_ptr), value :: tracker
            integer(c_size_t) :: contactbench_tracker_count
        end function

        function contactbench_tracker_pairs(tracker) bind(c)
            import :: c_ptr
            type(c_ptr), value :: tracker
            type(c_ptr) :: contactbench_tracker_pairs
        end function

        function contactbench_tracker_images(tracker) bind(c)
            import :: c_ptr
            type(c_ptr), value :: tracker
            type(c_ptr) :: contactbench_tracker_images
        end function
    end interface
end module
